"""What all engines that live in another Python do alike."""

from typing import ClassVar

from engines.interface.engine import Engine
from engines.interface.presets import Formulation, Preset
from engines.out_of_process.interpreter import Installation
from engines.out_of_process.lane import OutOfProcessLane
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.stepping.sequential import SequentialSimulation


class OutOfProcessEngine(Engine):
    """An engine whose lanes live in a child process; an adapter adds its name, its capabilities and its home."""

    home: ClassVar[Installation]
    lane_model: ClassVar[type[OutOfProcessLane]] = OutOfProcessLane

    def version(self) -> str:
        """Version of the engine, as its server states it."""
        return self.home.versions()["engine"]

    def python(self) -> str:
        """Version of the Python that it runs in."""
        return self.home.versions()["python"]

    def unavailable_reason(self) -> str | None:
        """Say why the engine cannot be used here; another Python is asked once."""
        return self.home.unavailable_reason()

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        process = self.home.process()
        return SequentialSimulation.build(lanes, lambda lane: self.lane_model(process, lane, preset, str(formulation)))
