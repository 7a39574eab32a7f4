"""Engines in environments of their own, and versions of engines, as engines."""

from dataclasses import replace

from packaging.utils import canonicalize_name

from engines.environments.environment import Environment, Record, unavailable_reason
from engines.environments.process import shared_process
from engines.environments.requirement import Requirement
from engines.environments.simulation import EnvironmentSimulation
from engines.interface.engine import Engine, EngineNotInstalled
from engines.interface.presets import Formulation, Preset
from engines.shared.wheel_engine import WheelEngine
from reference_lcp.chain.simulation import Lane, Simulation


class VersionedEngine(Engine):
    """A version of an engine, under a name of its own, that is the one beside the suite.

    Parameters
    ----------
    requirement
        The engine and the version.
    """

    def __init__(self, requirement: Requirement):
        self._adapter = requirement.adapter
        self.name = requirement.name  # type: ignore[misc]
        self.preparation = self._adapter.preparation  # type: ignore[misc]
        known = self._adapter.capabilities
        title = f"{known.title} {requirement.version}".strip()
        self.capabilities = replace(known, title=title, optional=known.optional or bool(requirement.version))  # type: ignore[misc]

    def version(self) -> str:
        """Version of the package."""
        return self._adapter.version()

    @property
    def states_laws_of(self) -> str:
        """Name of the engine: its laws hold for every version that its adapter takes."""
        return self._adapter.name

    def unavailable_reason(self) -> str | None:
        """``None``: it is there."""
        return None

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        return self._adapter.build(lanes, str(formulation), self._name_of(formulation, preset))

    def _name_of(self, formulation: Formulation, preset: Preset) -> str:
        own = preset.unchanged or preset
        name = next(name for name, known in self.capabilities.presets[formulation].items() if known is own)
        return ":".join([name, *preset.settings])


class EnvironmentEngine(VersionedEngine):
    """An engine, or a version of one, in an environment of its own."""

    def __init__(self, requirement: Requirement):
        super().__init__(requirement)
        self._environment = requirement.environment

    def version(self) -> str:
        """Version of the package that was installed."""
        return self._recorded().packages[canonicalize_name(self.capabilities.package)]

    def python(self) -> str:
        """Version of the environment's Python."""
        return self._recorded().python

    def unavailable_reason(self) -> str | None:
        """Reason why its environment cannot be used: it is missing, unfinished or changed; ``None`` if it can."""
        return unavailable_reason(self._environment)

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        process = shared_process(self._adapter, self._environment)
        return EnvironmentSimulation(process, lanes, str(formulation), self._name_of(formulation, preset))

    def _recorded(self) -> Record:
        record = self._environment.record()
        if record is None:
            raise EngineNotInstalled(f"{self.name}: {self.unavailable_reason()}")
        return record


def versioned_engine(registered: Engine, version: str) -> Engine:
    """Give a version of an engine: in its environment, or beside the suite where that has it and there is no other.

    Raises
    ------
    ParameterError
        If the engine has no versions, or its adapter does not take this one.
    """
    requirement = Requirement.of(registered, version)
    beside = requirement.adapter
    if requirement.environment.folder.is_dir() or beside.unavailable_reason() is not None:
        return EnvironmentEngine(requirement)
    return (VersionedEngine if requirement.met_by(beside.version()) else EnvironmentEngine)(requirement)


def engine_of_its_own_environment(registered: Engine) -> Engine | None:
    """Give an engine that is not beside the suite, where it has an environment of its own; ``None`` where not."""
    if not isinstance(registered, WheelEngine) or not Environment(registered.name).folder.is_dir():
        return None
    return None if registered.unavailable_reason() is None else EnvironmentEngine(Requirement(registered))
