"""Box2D 3: worlds that make way, discs in equilibrium across, and what pyb2d3 does not tell."""

import numpy as np
import pytest

from multibody_xval.engines.interface.tolerances import SINGLE
from multibody_xval.engines.interface.variant import Variant
from reference_lcp.chain.trajectory import State
from tests.engines.scheme_oracle import AMPLITUDE, STEPS, distance, lane_of, random_state, run, uneven_lane

pytestmark = pytest.mark.needs("box2d3")


def test_more_chains_run_than_box2d_has_room_for_worlds() -> None:
    """128 in a process; the 129th would have no number."""
    simulation = Variant("box2d3").build([lane_of()] * 130)
    ends = simulation.advance(State.at_rest(130, 7), 0, 3).positions
    assert np.all(ends == ends[0])
    assert ends[0, 0] != 0


def test_friction_of_a_contact_has_its_bound_from_the_first_step_on() -> None:
    """Discs that began where they just touch would be pressed with less for tens of steps."""
    lane, state = uneven_lane(), random_state()
    assert distance(lane, state, run("box2d3:contact", lane, state, 20)) <= 20 * SINGLE


@pytest.mark.parametrize("preset", ["tuned", "default", "recommended"])
def test_friction_read_from_momentum_is_the_bound_while_a_disc_slides(preset: str) -> None:
    lane, fast = lane_of(), np.zeros((1, 14))
    fast[0, 7:] = 100 * AMPLITUDE
    motion = run(f"box2d3:contact:{preset}", lane, State(np.zeros((1, 14)), fast), STEPS // 100)
    np.testing.assert_array_equal(motion.friction, np.broadcast_to(-lane.chain.friction_bound, motion.friction.shape))
