"""What all engines that run in another Python share."""

from typing import ClassVar

from engines.interface.engine import Engine
from engines.interface.presets import Formulation, Preset
from engines.out_of_process.interpreter import Installation
from engines.out_of_process.lane import OutOfProcessLane
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.stepping.sequential import SequentialSimulation


class OutOfProcessEngine(Engine):
    """An engine whose lanes live in a worker process; an adapter adds name, capabilities and installation."""

    installation: ClassVar[Installation]
    lane_model: ClassVar[type[OutOfProcessLane]] = OutOfProcessLane

    def version(self) -> str:
        """Version of the engine, as its server states it."""
        return self.installation.versions()["engine"]

    def python(self) -> str:
        """Version of the Python that it runs in."""
        return self.installation.versions()["python"]

    def unavailable_reason(self) -> str | None:
        """Reason why the engine cannot be used here; another Python is tried once."""
        return self.installation.unavailable_reason()

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        process = self.installation.process()
        return SequentialSimulation([self.lane_model(process, lane, preset, str(formulation)) for lane in lanes])
