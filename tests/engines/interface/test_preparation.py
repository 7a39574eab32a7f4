"""What an engine does before its first run."""

from engines.interface.presets import Formulation, Preparation, Preset
from engines.mujoco import MuJoCo
from reference_lcp.chain.simulation import Lane, Simulation


class Compiling(MuJoCo):
    """MuJoCo, as an engine that compiles for every number of lanes."""

    preparation = Preparation("compiles", 1.0, batches=(1, 3))

    def __init__(self) -> None:
        self.built: list[tuple[int, int]] = []

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        self.built.append((len(lanes), lanes[0].chain.cells))
        return super()._build(lanes, formulation, preset)


def test_batches_of_all_sizes_that_it_names_are_built() -> None:
    engine = Compiling()
    engine.prepare(2, "joint", "default")
    assert engine.built == [(1, 2), (3, 2)]
