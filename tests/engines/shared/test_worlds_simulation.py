"""Lanes as worlds: each gets and gives its numbers in units of its own, whatever the engine does with them."""

import numpy as np
import pytest

from multibody_xval.engines.shared.units import Units
from multibody_xval.engines.shared.warp_worlds import CHUNK, Rows
from multibody_xval.engines.shared.worlds_simulation import WorldsSimulation
from reference_lcp import Chain, HarmonicBase, Lane, State

CELLS, STEPS = 2, CHUNK + 3


class Ballistic:
    """Masses that go on as they began, in units of length and time; it notes what it is given."""

    def __init__(self):
        self.loads, self.pressing = [], []

    def set(self, positions, velocities):
        self._state = positions, velocities

    def steps(self, loads, pressing):
        self.loads += list(loads)
        self.pressing += list(pressing)
        positions, velocities = self._state
        rows = positions + np.arange(1, len(loads) + 1)[:, None, None] * velocities
        self._state = rows[-1], velocities
        return Rows(rows, np.broadcast_to(velocities, rows.shape).copy(), 0.5 * pressing, pressing.copy())


class Lanes(WorldsSimulation):
    """Two joints a cell, and forces as the worlds give them."""

    def subset(self, lanes):
        raise AssertionError("nobody asks for this")

    def _contact_forces(self, index, friction, normal_force, given):
        return friction * self._units[index].force, given


@pytest.fixture
def lanes() -> list[Lane]:
    """Two lanes whose units differ by powers of two."""
    made = []
    for amplitude, stiffness in ((1e-2, 1.0), (1e-5, 300.0)):
        chain = Chain.from_ratios(cells=CELLS, friction_ratio=0.3, stiffness_ratio=stiffness)
        drive = HarmonicBase.from_ratio(chain, 0.9, amplitude=amplitude)
        made.append(Lane(chain, drive, drive.period / 400))
    return made


def test_every_world_has_its_own_units(lanes) -> None:
    """Loads, bounds, positions, velocities and friction, over several chunks; the end is that of the last row."""
    units, worlds = [Units.of(lane) for lane in lanes], Ballistic()
    assert units[0].length != units[1].length
    simulation = Lanes(lanes, units, 2, worlds)
    random = np.random.default_rng(3)
    scale = np.array([[1e-2], [1e-5]])
    state = State(*(scale * random.normal(size=(2, 2, 2 * CELLS))))
    runs = simulation.run(state, 5, STEPS)
    for index, (lane, unit, run) in enumerate(zip(lanes, units, runs, strict=True)):
        seconds = unit.time * np.arange(1, STEPS + 1)[:, None]
        expected = state.positions[index] + seconds * state.velocities[index]
        assert run.positions == pytest.approx(expected, rel=1e-12, abs=1e-12 * np.max(np.abs(expected)))
        assert run.velocities == pytest.approx(np.tile(state.velocities[index], (STEPS, 1)), rel=1e-12)
        assert np.array(worlds.loads)[:, index] * unit.force == pytest.approx(lane.loads(5, STEPS), rel=1e-12)
        bound = np.tile(lane.chain.friction_bound, (STEPS, 1))
        assert np.array(worlds.pressing)[:, index] * unit.force == pytest.approx(bound, rel=1e-12)
        assert run.friction == pytest.approx(0.5 * bound, rel=1e-12)
    end = simulation.advance(state, 5, STEPS)
    for index, run in enumerate(runs):
        assert np.array_equal(end.positions[index], run.positions[-1])
        assert np.array_equal(end.velocities[index], run.velocities[-1])
