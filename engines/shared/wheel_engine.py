"""What all engines that pip installs beside the suite do alike."""

import importlib.util
from collections.abc import Callable, Mapping
from importlib.metadata import version
from typing import ClassVar

from engines.interface.engine import Engine
from engines.interface.presets import Formulation, Preset
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.stepping.sequential import LaneModel, SequentialSimulation

EXTRA = "pip install 'multibody-xval[engines]'"
"""How the optional engines are installed."""


class WheelEngine(Engine):
    """An engine whose package is in the Python of the suite; an adapter adds its name and its capabilities."""

    module: ClassVar[str]
    """Name under which the package is imported; its distribution is `Capabilities.package`."""
    advice: ClassVar[str] = EXTRA
    """What to do where the package is missing or too old."""
    oldest_major: ClassVar[int] = 0
    """Oldest major version with everything that the adapter uses."""
    lacking: ClassVar[str] = ""
    """What older versions lack."""
    lane_models: ClassVar[Mapping[Formulation, Callable[[Lane, Preset], LaneModel]]] = {}
    """What builds one lane, by formulation; for adapters whose lanes are advanced one after the other."""

    def version(self) -> str:
        """Version of the package."""
        return version(self.capabilities.package)

    def unavailable_reason(self) -> str | None:
        """Say why the engine cannot be used here, and what to do; ``None`` if it can."""
        package = self.capabilities.package
        if importlib.util.find_spec(self.module) is None:
            return f"the package {package} is not installed; {self.advice}"
        if int(self.version().split(".")[0]) < self.oldest_major:
            needed = f"version {self.oldest_major}.0 or newer is needed"
            return f"{package} {self.version()} has no {self.lacking}, {needed}; {self.advice}"
        return None

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        model = self.lane_models[formulation]
        return SequentialSimulation.build(lanes, lambda lane: model(lane, preset))
