"""Engines that pip installs beside the suite: their version, whether they are there, and their lanes."""

import importlib.util
from collections.abc import Callable, Mapping
from functools import cache
from importlib import metadata
from typing import ClassVar

from engines.interface.engine import Engine
from engines.interface.presets import Formulation, Preset
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.schemes.sequential import LaneModel, SequentialSimulation

installed_version = cache(metadata.version)
"""Version of a distribution, looked up once: every batch states it."""

NEWEST = ".9999"
"""What makes of the beginning of a version one that is as new as can be."""


class PipEngine(Engine):
    """An engine whose package pip installs; an adapter adds its name, its capabilities, its module and its lanes.

    An adapter whose lanes are advanced together, or share something, builds them itself.
    """

    module: ClassVar[str]
    """Name under which the package is imported."""

    versions: ClassVar[str] = ""
    """Versions of the package that the adapter takes, as pip has them, such as ``>=3.3.7,<5``; any without this."""

    apart: ClassVar[bool] = False
    """The package does not fit beside the suite: the engine is used in an environment of its own alone."""

    served: bool = False
    """This adapter runs in an environment of its own; see `engines.isolated.server`."""

    environment_packages: ClassVar[tuple[str, ...]] = ()
    """What the adapter needs besides where the engine has an environment of its own, as pip has it."""

    lane_models: ClassVar[Mapping[Formulation, Callable[[Lane, Preset], LaneModel]]] = {}
    """Model of one lane, by formulation."""

    def version(self) -> str:
        """Version of the package."""
        return installed_version(self.capabilities.package)

    def unavailable_reason(self) -> str | None:
        """Reason why the engine cannot be used here: its package is missing or too old; ``None`` if it can."""
        package = self.capabilities.package
        if self.apart and not self.served:
            return f"it needs an environment of its own; {self._remedy}"
        if importlib.util.find_spec(self.module) is None:
            return f"the package {package} is not installed; {self._remedy}"
        if not self.takes(self.version()):
            return f"{package} {self.version()} is installed, and its adapter takes {self.versions}; {self._remedy}"
        return None

    @classmethod
    def takes(cls, version: str) -> bool:
        """Tell whether the adapter takes a version, or one that begins so."""
        from packaging.specifiers import SpecifierSet

        versions = SpecifierSet(cls.versions)
        return any(versions.contains(each, prereleases=True) for each in (version, f"{version}{NEWEST}"))

    @property
    def _remedy(self) -> str:
        """The command that installs the package: engines that are optional come with an extra of the suite."""
        own = f"multibody-xval engines install {self.name}"
        if self.apart:
            return own
        beside = "'.[engines]' in the suite's folder" if self.capabilities.optional else self.capabilities.package
        return f"{own}, or pip install {beside}"

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        model = self.lane_models[formulation]
        return SequentialSimulation([model(lane, preset) for lane in lanes])
