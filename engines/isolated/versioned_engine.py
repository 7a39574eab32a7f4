"""Versions of engines, such as ``mujoco@3.3.7``, and engines in environments of their own: how they are run."""

import functools
import json
import pickle
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray
from packaging.specifiers import SpecifierSet
from packaging.utils import canonicalize_name
from packaging.version import Version

from engines.interface.engine import Engine, EngineNotInstalled
from engines.interface.presets import Formulation, Preset
from engines.interface.scene import Scene, SceneSetting, SceneWorld, formulation_of
from engines.isolated.environment import Environment, Record, unavailable_reason
from engines.isolated.out_of_process import ServedScene
from engines.isolated.process import REQUEST_LIMIT, STEP_LIMIT, Built, EngineProcess
from engines.shared.pip_engine import PipEngine
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.errors import ParameterError, shown
from reference_lcp.terminal import visible
from reference_lcp.validation import checked_count

EXAMPLE = "mujoco@3.3.7"
"""The name of a version, for messages."""

NEEDED = ("numpy", "packaging")
"""What every adapter needs beside its engine."""


@dataclass(frozen=True)
class Requirement:
    """An engine from a package index, in one version or in whatever its adapter takes."""

    adapter: PipEngine
    """The engine as it is registered."""
    version: str = ""
    """Beginning of the version, such as ``3.3.7`` or ``6``; empty for the newest one that the adapter takes."""

    @classmethod
    def of(cls, registered: Engine, version: str | None = None) -> Self:
        """Check that the engine comes from a package index, and that its adapter takes this version, or any."""
        name = f"engine = {shown(registered.name if version is None else f'{registered.name}@{version}')}"
        if not isinstance(registered, PipEngine):
            comes_with = "the suite" if registered.name == "reference" else "the system"
            raise ParameterError(f"{name}: it comes with {comes_with}; allowed: {registered.name}")
        if version is None:
            return cls(registered)
        try:
            normal = str(Version(version))
        except ValueError:  # of too many digits too
            raise ParameterError(f"{name} has no version after the @; allowed: one as in {EXAMPLE}") from None
        if normal != version:  # one version has one name, and one environment
            raise ParameterError(f"{name} is not how that version is written; allowed: {registered.name}@{normal}")
        if not registered.takes(version):
            package = registered.capabilities.package
            raise ParameterError(f"{name}: its adapter does not take that; allowed: {package} {registered.versions}")
        return cls(registered, version)

    @property
    def name(self) -> str:
        """Of the engine in an environment of its own."""
        return f"{self.adapter.name}@{self.version}" if self.version else self.adapter.name

    @property
    def environment(self) -> Environment:
        """The environment that it is installed into."""
        return Environment(self.name)

    @property
    def lines(self) -> list[str]:
        """The packages, as uv and pip take them."""
        own = SpecifierSet(self.adapter.versions) & SpecifierSet(self._beginning)
        return [f"{self.adapter.capabilities.package}{own}", *self.adapter.environment_packages, *NEEDED]

    def met_by(self, installed: str) -> bool:
        """Tell whether this version is one of those that are meant."""
        return SpecifierSet(self._beginning).contains(installed, prereleases=True)

    @property
    def _beginning(self) -> str:
        """The version as a specifier: whatever begins so; any but a plain release must be that very one."""
        if not self.version:
            return ""
        exact = Version(self.version)
        of_its_own = exact.is_prerelease or exact.is_postrelease or exact.local
        return f"=={self.version}" if of_its_own else f"=={exact.public}.*"


SERVER = Path(__file__).with_name("server.py")

PACKAGES = ("engines", "reference_lcp")
"""What the adapters of the suite are made of."""

FIRST_USE_LIMIT = 600.0
"""Seconds that an engine may take to be imported, and to build its first lanes: some compile for minutes then."""


def started(adapter: type[Engine], environment: Environment) -> EngineProcess:
    """Give a worker process, which starts with its first request, for one engine in its environment."""
    folders = {name: _folder(name) for name in dict.fromkeys([*PACKAGES, adapter.__module__.partition(".")[0]])}
    served = json.dumps({"module": adapter.__module__, "class": adapter.__qualname__, "folders": folders})
    return EngineProcess(environment.name, str(environment.interpreter), SERVER, served)


@functools.cache
def shared_process(adapter: type[Engine], environment: Environment, _folder: Path) -> EngineProcess:
    """Give the worker process that all lanes of an engine share."""
    return started(adapter, environment)


def _folder(package: str) -> str:
    """Give the folder that holds a package of this process."""
    file = sys.modules[package].__file__
    assert file is not None, "every package has a file"
    return str(Path(file).resolve().parents[1])


def tried_versions(adapter: Engine, environment: Environment) -> dict[str, str]:
    """Import the engine in its environment; gives the versions of engine and Python."""
    process = started(type(adapter), environment)
    try:
        return {name: visible(str(value)) for name, value in process.request("versions", FIRST_USE_LIMIT).items()}
    finally:
        process.close()


class EnvironmentSimulation(Simulation):
    """A simulation that the adapter builds in another process, and that is called there."""

    def __init__(self, process: EngineProcess, lanes: Sequence[Lane], formulation: str, preset: str):
        self.lanes = tuple(lanes)
        self._process = process
        self._options = formulation, preset
        self._built = Built(process, {"pickled": _pickled(self.lanes, *self._options)}, FIRST_USE_LIMIT)

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane; see `Simulation.run`."""
        return self._call(steps, "run", state, start, steps)

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance every lane, keep the final state; see `Simulation.advance`."""
        return self._call(steps, "advance", state, start, steps)

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> "EnvironmentSimulation":
        """Give the lanes of these indices, built anew."""
        return EnvironmentSimulation(self._process, [self.lanes[lane] for lane in lanes], *self._options)

    def close(self) -> None:
        """Let the worker drop the lanes."""
        self._built.close()

    def _call(self, steps: int, method: str, *arguments: Any) -> Any:
        limit = REQUEST_LIMIT + STEP_LIMIT * checked_count("steps", steps) * len(self.lanes)
        reply = self._built.request("call", limit, pickled=_pickled(method, *arguments))
        return pickle.loads(reply["pickled"].tobytes())


def _pickled(*values: Any) -> NDArray[np.uint8]:
    return np.frombuffer(pickle.dumps(values), np.uint8)


class VersionedEngine(Engine):
    """A version of an engine, under a name of its own, that is the one beside the suite."""

    def __init__(self, requirement: Requirement):
        self._adapter = requirement.adapter
        self.name = requirement.name  # type: ignore[misc]
        self.preparation = self._adapter.preparation  # type: ignore[misc]
        self.scene_step = self._adapter.scene_step  # type: ignore[misc]
        self.scene_worlds = self._adapter.scene_worlds  # type: ignore[misc]
        self.no_scenes = self._adapter.no_scenes  # type: ignore[misc]
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
        return EnvironmentSimulation(self._process(), lanes, str(formulation), self._name_of(formulation, preset))

    def _scene(self, scene: Scene, setting: SceneSetting) -> SceneWorld:
        name = self._name_of(formulation_of(scene), setting.preset)
        given = _pickled(scene, name, setting.time_step, setting.sleeping)
        return ServedScene(self._process(), {"pickled": given, "scene": True}, FIRST_USE_LIMIT)

    def _process(self) -> EngineProcess:
        """Give the worker process that all lanes and scenes of this engine share."""
        return shared_process(type(self._adapter), self._environment, self._environment.folder)

    def _recorded(self) -> Record:
        record = self._environment.record()
        if record is None:
            raise EngineNotInstalled(f"{self.name}: {self.unavailable_reason()}")
        return record


def versioned_engine(registered: Engine, version: str) -> Engine:
    """Give a version of an engine: in its environment, or beside the suite where that has it and there is no other."""
    requirement = Requirement.of(registered, version)
    beside = requirement.adapter
    if requirement.environment.is_there or beside.unavailable_reason() is not None:
        return EnvironmentEngine(requirement)
    return (VersionedEngine if requirement.met_by(beside.version()) else EnvironmentEngine)(requirement)


def engine_of_its_own_environment(registered: Engine) -> Engine | None:
    """Give an engine that is not beside the suite, where it has an environment of its own; ``None`` where not."""
    if not isinstance(registered, PipEngine) or not Environment(registered.name).is_there:
        return None
    return None if registered.unavailable_reason() is None else EnvironmentEngine(Requirement(registered))
