"""What runs leave behind, how they restart and how they end, in engines whose adapters take care of it."""

import numpy as np
import pytest

from multibody_xval.engines.interface.variant import Variant
from reference_lcp.chain.trajectory import State
from tests.engines.scheme_oracle import (
    AMPLITUDE,
    STEPS,
    assert_same_bits,
    lane_of,
    random_state,
    uneven_lane,
    unstable_lane,
)
from tests.installed import each_variant


def each(*names: str) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("one", each_variant(map(Variant.parse, names)))


@each("ode", "ode:contact", "drake", "drake:contact", "drake:contact:sap", "exudyn-regularised", "exudyn-bristle")
def test_nothing_is_remembered_between_runs(one: Variant) -> None:
    lanes = [lane_of(), uneven_lane()]
    simulation = one.build(lanes)
    first = simulation.run(random_state(2), 0, STEPS)
    simulation.run(State.at_rest(2, 7), 50, 77)
    again, fresh = simulation.run(random_state(2), 0, STEPS), one.build(lanes).run(random_state(2), 0, STEPS)
    for runs in zip(first, again, fresh, strict=True):
        for other in runs[1:]:
            assert_same_bits(runs[0], other)
            assert np.array_equal(runs[0].end.internal_state, other.end.internal_state)


@each("ode", "ode:contact", "drake", "drake:contact", "drake:contact:sap", "siconos", "pybullet", "pybullet:contact")
def test_a_closed_simulation_opens_again(one: Variant) -> None:
    """Closing a subset may close a world that it shares; the others go on."""
    simulation = one.build([lane_of(), lane_of(1.0)])
    first = simulation.run(random_state(2), 0, 10)
    simulation.subset([0]).close()
    for motion, again in zip(first, simulation.run(random_state(2), 0, 10), strict=True):
        assert_same_bits(motion, again)
    simulation.close()
    for motion, again in zip(first, simulation.run(random_state(2), 0, 10), strict=True):
        assert_same_bits(motion, again)
    simulation.close()


@each("box2d", "ode", "rapier", "siconos:joint:euler")
def test_an_unstable_motion_ends_as_numbers_and_leaves_later_runs_alone(one: Variant) -> None:
    simulation = one.build([unstable_lane()])
    before = simulation.advance(State.at_rest(1, 7), 0, 3)
    assert np.max(np.abs(simulation.advance(State.at_rest(1, 7), 0, 400).positions)) > 1e6 * AMPLITUDE
    assert np.array_equal(simulation.advance(State.at_rest(1, 7), 0, 3).positions, before.positions)
