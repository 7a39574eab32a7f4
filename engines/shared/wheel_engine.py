"""Engines that pip installs beside the suite: their version, whether they are there, and their lanes."""

import importlib.util
from collections.abc import Callable, Mapping
from functools import cache
from importlib import metadata
from typing import ClassVar

from engines.interface.engine import Engine
from engines.interface.presets import Formulation, Preset
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.stepping.sequential import LaneModel, SequentialSimulation

installed_version = cache(metadata.version)
"""Version of a distribution, looked up once: every batch states it."""


class WheelEngine(Engine):
    """An engine whose package is a wheel; an adapter adds its name, its capabilities, its module and its lanes.

    An adapter whose lanes are advanced together, or share something, builds them itself.
    """

    module: ClassVar[str]
    """Name under which the package is imported."""

    needs: ClassVar[tuple[int, str] | None] = None
    """Oldest major version that the adapter takes, and what the package had not before it; any without this."""

    lane_models: ClassVar[Mapping[Formulation, Callable[[Lane, Preset], LaneModel]]] = {}
    """Model of one lane, by formulation."""

    def version(self) -> str:
        """Version of the package."""
        return installed_version(self.capabilities.package)

    def unavailable_reason(self) -> str | None:
        """Reason why the engine cannot be used here: its package is missing or too old; ``None`` if it can."""
        package = self.capabilities.package
        if importlib.util.find_spec(self.module) is None:
            return f"the package {package} is not installed; {self._remedy}"
        if self.needs is not None and int(self.version().split(".")[0]) < self.needs[0]:
            oldest, novelty = self.needs
            lacking = f"{package} {self.version()} has no {novelty}, version {oldest}.0 or newer is needed"
            return f"{lacking}; {self._remedy}"
        return None

    @property
    def _remedy(self) -> str:
        """The command that installs the package: engines that are optional come with an extra of the suite."""
        named = "'multibody-xval[engines]'" if self.capabilities.optional else self.capabilities.package
        return f"pip install {named}"

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        model = self.lane_models[formulation]
        return SequentialSimulation([model(lane, preset) for lane in lanes])
