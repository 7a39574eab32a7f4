"""Drake: what its actuators, its steps and its records do, and what of that the adapter has to mind."""

import numpy as np
import pytest

from reference_lcp.chain.drives import HarmonicBase, StillBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from tests.engines.scheme_oracle import AMPLITUDE, STEPS, built, lane_of, random_state, run, with_coefficients

pytestmark = pytest.mark.needs("drake")


def test_a_stuck_contact_is_held_where_it_is_and_not_drawn_to_the_middle() -> None:
    """Drake's stiffest actuators have no share of a spring."""
    lane, offset = lane_of(5.0), 0.4 * AMPLITUDE
    still = Lane(lane.chain, StillBase(AMPLITUDE), lane.time_step)
    motion = run("drake", still, State(np.repeat([0.0, offset], 7)[None], np.zeros((1, 14))))
    np.testing.assert_allclose(motion.friction, lane.chain.inner_stiffness[0] * offset, rtol=2e-3)
    np.testing.assert_allclose(motion.inner_positions - motion.outer_positions, offset, rtol=1e-3)


@pytest.mark.parametrize("frequency_ratio", [0.23, 0.71, 1.37, 1.91])
def test_no_step_is_lost_or_taken_twice_with_time_in_seconds(frequency_ratio: float) -> None:
    """Drake counts steps by their times; those are no whole numbers in SI units, and are in units of the lane."""
    lane, rest = lane_of(0.0, frequency_ratio), State.at_rest(1, 7)
    seconds, steps = (run(f"drake:joint:{preset}", lane, rest, 5000) for preset in ("default", "tuned"))
    np.testing.assert_allclose(seconds.positions, steps.positions, rtol=0, atol=1e-9 * AMPLITUDE)


@pytest.mark.parametrize("preset", ["sap", "similar"])
def test_a_gliding_sphere_is_lifted_by_its_slip_in_a_step_times_the_coefficient(preset: str) -> None:
    """Pulled along at constant speed, it swings about that height."""
    lane, slip, heights = Lane(Chain.from_ratios(cells=1, friction_ratio=0.3), StillBase(AMPLITUDE), 1e-3), 0.2, []
    for speed in (0.0, slip):
        velocity = np.array([[0.0, speed]])
        simulation, state, places = built(f"drake:contact:{preset}", lane), State(np.zeros((1, 2)), velocity), []
        for step in range(800):
            across = simulation.advance(state, step, 1).internal_state
            places.append(across[0, 0])
            state = State(np.zeros((1, 2)), velocity, across)  # back where it was along the plane, as fast as before
        heights.append(np.mean(places))
    assert heights[1] - heights[0] == pytest.approx(0.5 * slip * lane.time_step, rel=0.1)


def test_below_drakes_own_floor_every_stiction_tolerance_acts_alike() -> None:
    """μ R_t γ_n with R_t = 1e-3 w: there the orbits stall, and the tuned tolerance stays above it."""
    lane = lane_of(1.0, 0.9)
    ends = [run("drake:contact", lane, random_state(), stiction=value).positions for value in (3e-5, 1e-9, 1e-12)]
    assert np.array_equal(ends[1], ends[2])
    assert not np.array_equal(ends[0], ends[1])


@pytest.mark.parametrize("coefficient", [0.001, 3.0, [0.5, 0.05, 0.3, 1.0, 0.02, 2.0, 0.7]])
def test_only_the_bound_enters_the_motion_whatever_the_coefficient(coefficient: object) -> None:
    """To what Drake's solver leaves: it stops relative to the largest impulse, which grows as 1 / μ."""
    lane, usual = with_coefficients(coefficient), lane_of()
    motion, expected = (run("drake:contact", one, random_state()) for one in (lane, usual))
    tolerance = 1e-7 / float(np.min(coefficient)) * AMPLITUDE
    np.testing.assert_allclose(motion.positions, expected.positions, rtol=0, atol=tolerance)
    assert motion.normal_force == pytest.approx(np.broadcast_to(lane.chain.normal_force, (STEPS, 7)), rel=1e-9)


def test_long_chain_of_contacts_moves_as_that_of_joints_does(capfd) -> None:
    """Twenty planes: the fourteenth half space ends the process. Both laws differ by their creep only."""
    chain = Chain.from_ratios(cells=20, friction_ratio=0.3)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.5, AMPLITUDE), STEPS)
    contact, joint = (run(f"drake:{each}", lane, State.at_rest(1, 20), 2 * STEPS) for each in ("contact", "joint"))
    difference = np.max(np.abs(contact.positions - joint.positions)) / AMPLITUDE
    assert difference < 1e-3 < np.max(np.abs(joint.positions)) / AMPLITUDE
    assert capfd.readouterr().err == "", "Drake warns of something"
