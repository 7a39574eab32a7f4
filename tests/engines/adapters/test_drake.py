"""Drake: what its actuators, its steps and its records do, and what of that the adapter has to mind."""

import numpy as np
import pytest

from multibody_xval.engines.drake import Drake
from reference_lcp.chain.drives import HarmonicBase, StillBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from tests.engines.scheme_oracle import (
    AMPLITUDE,
    STEPS,
    built_with,
    lane_of,
    random_state,
    uneven_lane,
    unstable_lane,
    with_coefficients,
)

pytestmark = pytest.mark.needs("drake")


gliding = pytest.mark.parametrize("preset", ["sap", "similar"])


def run(lane: Lane, state: State, steps: int, formulation: str = "joint", preset: str = "tuned") -> Trajectory:
    return Drake().build([lane], formulation, preset).run(state, 0, steps)[0]


def linear_scheme(lane: Lane, state: State, steps: int) -> np.ndarray:
    """Euler steps without friction, velocities first, with dashpots at the end of the step."""
    chain, dt = lane.chain, lane.time_step
    # Drake's matrix is of joint coordinates, but (M + δt C) is the same form in any coordinates.
    left = np.linalg.inv(chain.mass_matrix + dt * chain.damping_matrix)
    position, velocity = state.positions[0], state.velocities[0]
    rows = []
    for load in lane.loads(0, steps):
        force = -chain.stiffness_matrix @ position - chain.damping_matrix @ velocity
        force[0] += load
        velocity = velocity + dt * left @ force
        position = position + dt * velocity
        rows.append(position)
    return np.array(rows)


def test_beyond_drakes_own_limit_every_gain_acts_alike() -> None:
    lane, state = lane_of(), random_state()
    ends = [built_with(Drake(), lane, d=gain).advance(state, 0, STEPS).positions for gain in (1e5, 1e6, 1e9)]
    assert np.array_equal(ends[0], ends[1])
    assert np.array_equal(ends[1], ends[2])


def test_a_stuck_contact_is_held_where_it_is_and_not_drawn_to_the_middle() -> None:
    """Drake's stiffest actuators have no share of a spring."""
    moving = lane_of(5.0)
    lane = Lane(moving.chain, StillBase(AMPLITUDE), moving.time_step)
    offset = 0.4 * AMPLITUDE
    state = State(np.repeat([0.0, offset], 7)[None], np.zeros((1, 14)))
    trajectory = run(lane, state, STEPS)
    np.testing.assert_allclose(trajectory.friction, lane.chain.inner_stiffness[0] * offset, rtol=2e-3)
    relative = trajectory.inner_positions - trajectory.outer_positions
    np.testing.assert_allclose(relative, offset, rtol=1e-3)


@pytest.mark.parametrize("frequency_ratio", [0.23, 0.71, 1.37, 1.91])
def test_no_step_is_lost_or_taken_twice_with_time_in_seconds(frequency_ratio: float) -> None:
    """Drake counts steps by their times; those are no whole numbers in SI units."""
    lane = lane_of(0.0, frequency_ratio)
    trajectory = run(lane, State.at_rest(1, 7), 5000, preset="default")
    expected = linear_scheme(lane, State.at_rest(1, 7), 5000)
    assert trajectory.positions.shape == expected.shape
    np.testing.assert_allclose(trajectory.positions, expected, rtol=0, atol=1e-9 * AMPLITUDE)


def test_a_motion_that_diverges_stops_with_drakes_reason_and_leaves_nothing_behind() -> None:
    simulation = Drake().build([unstable_lane()])
    before = simulation.advance(State.at_rest(1, 7), 0, 3).positions
    with pytest.raises(RuntimeError, match=r"drake stopped in step \d+ of 4000: .*NaN"):
        simulation.advance(State.at_rest(1, 7), 0, 4000)
    assert np.array_equal(simulation.advance(State.at_rest(1, 7), 0, 3).positions, before)


def test_the_reason_for_a_missing_package_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("multibody_xval.engines.shared.pip_engine.importlib.util.find_spec", lambda _: None)
    said = "the package drake is not installed; pip install '.[engines]' in the suite's folder"
    assert Drake().unavailable_reason() == said


def test_in_the_tuned_contact_nothing_moves_across_the_plane() -> None:
    lane = lane_of()
    trajectory = run(lane, random_state(), STEPS, "contact")
    assert trajectory.internal_state is not None
    depth = -trajectory.internal_state[:7]
    np.testing.assert_allclose(depth, depth[0], rtol=1e-12)
    np.testing.assert_allclose(trajectory.normal_force, lane.chain.normal_force[0], rtol=1e-12)


@gliding
def test_where_friction_acts_back_a_sliding_sphere_is_lifted_and_bounces(preset: str) -> None:
    """The mean stays what presses, so that it is the same chain; the force itself swings, and friction with it."""
    lane = lane_of(0.3, 0.6)
    trajectory = run(lane, State.at_rest(1, 7), 8 * STEPS, "contact", preset)
    share = trajectory.normal_force[:, 0] / lane.chain.normal_force[0]
    assert np.ptp(share) > 0.1
    assert np.mean(share) == pytest.approx(1, abs=0.01)


@gliding
def test_a_gliding_sphere_is_lifted_by_its_slip_in_a_step_times_the_coefficient(preset: str) -> None:
    """Pulled along at constant speed, it swings about that height."""
    chain = Chain.from_ratios(cells=1, friction_ratio=0.3)
    lane = Lane(chain, StillBase(AMPLITUDE), 1e-3)
    slip = 0.2
    heights = []
    for speed in (0.0, slip):
        state = State(np.zeros((1, 2)), np.array([[0.0, speed]]))
        simulation = Drake().build([lane], "contact", preset)
        places = []
        for step in range(800):
            state = simulation.advance(state, step, 1)
            assert state.internal_state is not None
            places.append(state.internal_state[0, 0])
            # Back where it was along the plane, and as fast as before.
            state = State(np.zeros((1, 2)), np.array([[0.0, speed]]), state.internal_state)
        heights.append(np.mean(places))
    assert heights[1] - heights[0] == pytest.approx(0.5 * slip * lane.time_step, rel=0.1)


@gliding
def test_the_place_across_the_plane_is_part_of_the_state(preset: str) -> None:
    simulation = Drake().build([lane_of()], "contact", preset)
    whole = simulation.advance(random_state(), 0, 200)
    half = simulation.advance(random_state(), 0, 100)
    assert simulation.advance(half, 100, 100).positions == pytest.approx(whole.positions, abs=1e-12 * AMPLITUDE)
    forgetful = simulation.advance(State(half.positions, half.velocities), 100, 100)
    assert np.max(np.abs(forgetful.positions - whole.positions)) > 1e-6 * AMPLITUDE


def test_the_default_contact_starts_where_drakes_own_stiffness_carries_the_normal_force() -> None:
    lane = uneven_lane()
    trajectory = run(lane, random_state(), STEPS, "contact", "default")
    given = np.broadcast_to(lane.chain.normal_force, (STEPS, 7))
    np.testing.assert_allclose(trajectory.normal_force, given, rtol=1e-8)


def test_below_drakes_own_floor_every_stiction_tolerance_acts_alike() -> None:
    """μ R_t γ_n with R_t = 1e-3 w: there the orbits stall, and the tuned tolerance stays above it."""
    lane = lane_of(1.0, 0.9)
    ends = [
        built_with(Drake(), lane, "contact", stiction=value).advance(random_state(), 0, STEPS).positions
        for value in (3e-5, 1e-9, 1e-12)
    ]
    assert np.array_equal(ends[1], ends[2])
    assert not np.array_equal(ends[0], ends[1])


@pytest.mark.parametrize("coefficient", [0.001, 0.1, 3.0, [0.5, 0.05, 0.3, 1.0, 0.02, 2.0, 0.7]])
def test_only_the_bound_enters_the_motion_whatever_the_coefficient(coefficient: object) -> None:
    """To what Drake's solver leaves: it stops relative to the largest impulse, which grows as 1 / μ."""
    lane, usual = with_coefficients(coefficient), lane_of()
    motion, expected = (run(one, random_state(), STEPS, "contact") for one in (lane, usual))
    tolerance = 1e-7 / float(np.min(coefficient)) * AMPLITUDE
    np.testing.assert_allclose(motion.positions, expected.positions, rtol=0, atol=tolerance)
    assert motion.normal_force == pytest.approx(np.broadcast_to(lane.chain.normal_force, (STEPS, 7)), rel=1e-9)


def test_long_chain_of_contacts_moves_as_that_of_joints_does(capfd) -> None:
    """Twenty planes: the fourteenth half space ends the process. Both laws differ by their creep only."""
    chain = Chain.from_ratios(cells=20, friction_ratio=0.3)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.5, AMPLITUDE), STEPS)
    contact, joint = (run(lane, State.at_rest(1, 20), 2 * STEPS, formulation) for formulation in ("contact", "joint"))
    motion = np.max(np.abs(joint.positions)) / AMPLITUDE
    difference = np.max(np.abs(contact.positions - joint.positions)) / AMPLITUDE
    assert difference < 1e-3 < motion, difference
    assert capfd.readouterr().err == "", "Drake warns of something"
