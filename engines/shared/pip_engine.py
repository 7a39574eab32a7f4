"""Engines that pip installs beside the suite: their version, whether they are there, and their lanes."""

import importlib.util
from collections.abc import Callable, Mapping
from functools import cache
from importlib import metadata
from typing import ClassVar

from multibody_xval.engines.interface.engine import Engine
from multibody_xval.engines.interface.presets import Formulation, Preset
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.schemes.sequential import LaneModel, SequentialSimulation


@cache
def installed_version(package: str) -> str:
    """Version of a distribution, or nothing if it is not installed; looked up once, for every batch states it."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return ""


class PipEngine(Engine):
    """An engine whose package pip installs; an adapter adds its name, its capabilities, its module and its lanes.

    An adapter whose lanes are advanced together, or share something, builds them itself.
    """

    module: ClassVar[str]
    """Name under which the package is imported."""

    versions: ClassVar[str] = ""
    """Versions of the package that the adapter takes, as pip has them, such as ``>=3.3.7,<5``; any without this."""

    same_files: ClassVar[str] = ""
    """Another distribution that installs the same files, in which case pip lets each overwrite the other's."""

    extra: ClassVar[str] = "engines"
    """Extra of the suite that has the package, if the engine is optional."""

    lane_models: ClassVar[Mapping[Formulation, Callable[[Lane, Preset], LaneModel]]] = {}
    """Model of one lane, by formulation."""

    def version(self) -> str:
        """Version of the package, or of the other distribution that has its files, if only that is installed."""
        return next(filter(None, self._installed().values()), "")

    def unavailable_reason(self) -> str | None:
        """Reason why the engine cannot be used here: its package is missing or too old; ``None`` if it can."""
        from packaging.specifiers import SpecifierSet

        package = self.capabilities.package
        if importlib.util.find_spec(self.module) is None:
            return f"the package {package} is not installed; {self._remedy}"
        installed = self._installed()
        if len(set(installed.values())) > 1:
            found = " and ".join(f"{name} {version}" for name, version in installed.items())
            return f"{found} are both installed, and overwrite each other's files; allowed: equal versions"
        if not SpecifierSet(self.versions).contains(self.version(), prereleases=True):
            return f"{package} {self.version()} is installed, and its adapter takes {self.versions}; {self._remedy}"
        return None

    def _installed(self) -> dict[str, str]:
        """Versions of the distributions that are installed, of the two which may have the engine's files."""
        names = filter(None, (self.capabilities.package, self.same_files))
        return {name: version for name in names if (version := installed_version(name))}

    @property
    def _remedy(self) -> str:
        """The command that installs the package: engines that are optional come with an extra of the suite."""
        if self.capabilities.optional:
            return f"pip install '.[{self.extra}]' in the suite's folder"
        return f"pip install '{self.capabilities.package}{self.versions}'"

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        model = self.lane_models[formulation]
        return SequentialSimulation([model(lane, preset) for lane in lanes])
