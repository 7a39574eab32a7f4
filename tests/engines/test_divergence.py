"""Motions that diverge, and parts of a batch that are closed: the others and later runs are as if nothing had been."""

import numpy as np
import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.engines.shared.box_geometry import PLATE
from reference_lcp.chain.trajectory import State
from tests.engines.scheme_oracle import AMPLITUDE, assert_same_bits, lane_of, random_state, unstable_lane
from tests.installed import each_variant


def each(*names: str) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("one", each_variant(map(Variant.parse, names)))


@each("box2d3", "dart", "genesis", "genesis:contact", "mujoco", "mujoco:contact", "mujoco-warp",
      "mujoco-warp:contact", "newton", "newton:contact", "newton:contact:default", "ode", "pinocchio", "pybullet",
      "pymunk", "rapier", "sapien", "siconos:joint:euler")  # fmt: skip
def test_a_motion_that_diverges_is_numbers_and_leaves_neighbours_and_later_runs_alone(one: Variant) -> None:
    """At numbers that are not finite some engines would end every chain of a scene."""
    simulation, state = one.build([unstable_lane(), lane_of()]), State.at_rest(2, 7)
    before = simulation.run(state, 0, 3)
    diverged, calm = simulation.run(state, 0, 400)
    assert np.max(np.abs(diverged.positions)) > 1e6 * AMPLITUDE
    assert np.all(np.isfinite(diverged.positions))
    assert_same_bits(calm, one.build([lane_of()]).run(state.subset([1]), 0, 400)[0])
    for first, second in zip(before, simulation.run(state, 0, 3), strict=True):
        assert_same_bits(first, second)
    simulation.close()


@each("drake", "drake:contact", "box2d3:contact", "dart:contact", "ode:contact", "pybullet:contact", "pymunk:contact",
      "rapier:contact", "sapien:contact")  # fmt: skip
def test_an_engine_that_stops_says_why_and_goes_on_afterwards(one: Variant) -> None:
    """Beyond the end of its plate a body would feel no friction; Drake finds numbers that are not finite."""
    simulation, state = one.build([unstable_lane()]), State.at_rest(1, 7)
    before = simulation.run(state, 0, 3)[0]
    with pytest.raises(RuntimeError, match=r"its plate ends at|left the plate|drake stopped in step \d+ of 400: .*NaN"):
        simulation.run(state, 0, 400)
    assert_same_bits(before, simulation.run(state, 0, 3)[0])
    simulation.close()


@each("box2d3:contact", "dart:contact", "pymunk:contact", "rapier:contact", "sapien:contact")
def test_a_search_may_try_a_state_off_the_plate_and_a_motion_that_ends_there_is_refused(one: Variant) -> None:
    """Newton's steps led Box2D 3's search there at a friction ratio of 1, and its run failed instead of going on."""
    simulation, positions = one.build([lane_of()]), np.zeros((1, 14))
    positions[0, 7] = 2 * PLATE * AMPLITUDE
    state = State(positions, np.zeros((1, 14)))
    assert np.all(np.isfinite(simulation.advance(state, 0, 3).positions))
    with pytest.raises(RuntimeError, match="its plate ends at"):
        simulation.run(state, 0, 3)
    simulation.close()


@each("ode", "ode:contact", "drake", "drake:contact", "drake:contact:sap", "siconos", "pybullet", "pybullet:contact")
def test_closing_a_subset_may_close_a_world_that_it_shares_and_the_others_go_on(one: Variant) -> None:
    simulation = one.build([lane_of(), lane_of(1.0)])
    first = simulation.run(random_state(2), 0, 10)
    simulation.subset([0]).close()
    for motion, again in zip(first, simulation.run(random_state(2), 0, 10), strict=True):
        assert_same_bits(motion, again)
    simulation.close()
