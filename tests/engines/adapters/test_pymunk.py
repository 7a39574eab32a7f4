"""pymunk: what only its joints, its springs and its order of integration do."""

import dataclasses
import math

import numpy as np
import pytest

from multibody_xval.engines.pymunk import Pymunk
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from tests.engines.scheme_oracle import AMPLITUDE, STEPS, built_with, lane_of, random_state, scheme, uneven_lane

pytestmark = pytest.mark.needs("pymunk")


def run(lane: Lane, state: State, steps: int = STEPS, **options: object) -> Trajectory:
    return built_with(Pymunk(), lane, **options).run(state, 0, steps)[0]


def test_forces_at_the_positions_before_they_are_advanced_create_energy() -> None:
    """Positions come first in Chipmunk: forces set at the start of a step act a step late, and feed vibrations."""
    lane = lane_of(0.0, damping_ratio=0.0)
    late = run(lane, random_state(), 2 * STEPS, positions="as they are")
    expected = scheme(lane, random_state(), 2 * STEPS)[0]
    assert np.linalg.norm(late.positions[STEPS:]) > 1.2 * np.linalg.norm(expected[STEPS:])


def test_joints_with_their_own_bias_pull_contacts_back_to_where_they_started() -> None:
    """The inner mass starts beside the outer one, held by a friction that its spring does not overcome."""
    lane = lane_of(5.0)
    state = State(np.concatenate([np.zeros(7), np.full(7, AMPLITUDE)])[None], np.zeros((1, 14)))
    gaps = [
        np.max(np.abs(motion.inner_positions - motion.outer_positions - AMPLITUDE)) / AMPLITUDE
        for motion in (run(lane, state), run(lane, state, max_bias=math.inf))
    ]
    assert gaps[0] < 1e-12
    assert gaps[1] > 0.5


@pytest.mark.parametrize("preset", ["tuned", "default"])
def test_reported_friction_explains_the_momentum_of_every_inner_mass(preset: str) -> None:
    """pymunk tells the size of an impulse, and not its sign."""
    lane = uneven_lane()
    motion = Pymunk().build([lane], preset=preset).run(random_state(), 0, STEPS)[0]
    expected = scheme(lane, random_state(), STEPS)[2]
    scale = np.max(lane.chain.friction_bound)
    moving = np.abs(expected) > 0.01 * scale
    agreeing = np.mean(np.sign(motion.friction[moving]) == np.sign(expected[moving]))
    assert agreeing == 1 if preset == "tuned" else agreeing > 0.95


def test_what_is_read_is_written_by_pymunk_into_its_own_memory() -> None:
    """Many simulations side by side, dropped in between: a reading must not outlive, nor move, what it points to."""
    simulations = [Pymunk().build([lane_of()], preset=preset) for preset in ("tuned", "default") * 10]
    ends = [simulation.advance(random_state(), 0, 50).positions for simulation in simulations]
    del simulations[::3]
    again = [simulation.advance(random_state(), 0, 50).positions for simulation in simulations]
    assert all(any(np.array_equal(one, other) for other in ends[:2]) for one in again)


def test_a_chain_that_diverges_leaves_its_neighbours_alone() -> None:
    """Steps far beyond the limit of stability send one chain to infinity within the run."""
    stiff = lane_of(0.0, 0.6, stiffness_ratio=1e6)
    unstable = dataclasses.replace(stiff, time_step=lane_of(0.0).time_step)
    lanes, state = [lane_of(0.3), unstable, lane_of(1.0, 0.9)], random_state(3)
    motion = Pymunk().build(lanes).run(state, 0, STEPS)
    assert np.max(np.abs(motion[1].positions)) > 1e12 * AMPLITUDE
    for index in (0, 2):
        alone = Pymunk().build([lanes[index]]).run(state.subset([index]), 0, STEPS)[0]
        np.testing.assert_allclose(motion[index].positions, alone.positions, rtol=0, atol=1e-11 * AMPLITUDE)
