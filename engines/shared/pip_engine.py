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

installed_version = cache(metadata.version)
"""Version of a distribution, looked up once: every batch states it."""


class PipEngine(Engine):
    """An engine whose package pip installs; an adapter adds its name, its capabilities, its module and its lanes.

    An adapter whose lanes are advanced together, or share something, builds them itself.
    """

    module: ClassVar[str]
    """Name under which the package is imported."""

    versions: ClassVar[str] = ""
    """Versions of the package that the adapter takes, as pip has them, such as ``>=3.3.7,<5``; any without this."""

    extra: ClassVar[str] = "engines"
    """Extra of the suite that has the package, if the engine is optional."""

    lane_models: ClassVar[Mapping[Formulation, Callable[[Lane, Preset], LaneModel]]] = {}
    """Model of one lane, by formulation."""

    def version(self) -> str:
        """Version of the package."""
        return installed_version(self.capabilities.package)

    def unavailable_reason(self) -> str | None:
        """Reason why the engine cannot be used here: its package is missing or too old; ``None`` if it can."""
        from packaging.specifiers import SpecifierSet

        package = self.capabilities.package
        if importlib.util.find_spec(self.module) is None:
            return f"the package {package} is not installed; {self._remedy}"
        if not SpecifierSet(self.versions).contains(self.version(), prereleases=True):
            return f"{package} {self.version()} is installed, and its adapter takes {self.versions}; {self._remedy}"
        return None

    @property
    def _remedy(self) -> str:
        """The command that installs the package: engines that are optional come with an extra of the suite."""
        if self.capabilities.optional:
            return f"pip install '.[{self.extra}]' in the suite's folder"
        return f"pip install '{self.capabilities.package}{self.versions}'"

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        model = self.lane_models[formulation]
        return SequentialSimulation([model(lane, preset) for lane in lanes])
