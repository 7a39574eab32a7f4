"""How engines go on after a subset of their chains is closed, and after a motion that diverges."""

import numpy as np
import pytest

from multibody_xval.engines.interface.variant import Variant
from reference_lcp.chain.trajectory import State
from tests.engines.scheme_oracle import AMPLITUDE, assert_same_bits, lane_of, random_state, unstable_lane
from tests.installed import each_variant


def each(*names: str) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("one", each_variant(map(Variant.parse, names)))


@each("ode", "ode:contact", "drake", "drake:contact", "drake:contact:sap", "siconos", "pybullet", "pybullet:contact")
def test_closing_a_subset_may_close_a_world_that_it_shares_and_the_others_go_on(one: Variant) -> None:
    simulation = one.build([lane_of(), lane_of(1.0)])
    first = simulation.run(random_state(2), 0, 10)
    simulation.subset([0]).close()
    for motion, again in zip(first, simulation.run(random_state(2), 0, 10), strict=True):
        assert_same_bits(motion, again)
    simulation.close()


@each("box2d", "ode", "rapier", "siconos:joint:euler")
def test_an_unstable_motion_ends_as_numbers_and_leaves_later_runs_alone(one: Variant) -> None:
    simulation = one.build([unstable_lane()])
    before = simulation.advance(State.at_rest(1, 7), 0, 3)
    assert np.max(np.abs(simulation.advance(State.at_rest(1, 7), 0, 400).positions)) > 1e6 * AMPLITUDE
    assert np.array_equal(simulation.advance(State.at_rest(1, 7), 0, 3).positions, before.positions)
