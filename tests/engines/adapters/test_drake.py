"""Drake: what its actuators, its steps and its records do, and what of that the adapter has to mind."""

import dataclasses

import numpy as np
import pytest

from multibody_xval.engines.drake import Drake
from multibody_xval.engines.drake.contact import script_numbers
from multibody_xval.engines.drake.joint import actuator_gains
from multibody_xval.engines.drake.step_model import contact_scale
from multibody_xval.engines.interface.registry import law_of
from multibody_xval.engines.interface.variant import Variant
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
    scheme,
    uneven_lane,
    unstable_lane,
    with_coefficients,
)

pytestmark = pytest.mark.needs("drake")


both_formulations = pytest.mark.parametrize("formulation", ["joint", "contact"])
gliding = pytest.mark.parametrize("preset", ["sap", "similar"])


def run(lane: Lane, state: State, steps: int, formulation: str = "joint", preset: str = "tuned") -> Trajectory:
    return Drake().build([lane], formulation, preset).run(state, 0, steps)[0]


def linear_scheme(lane: Lane, state: State, steps: int, implicit: bool) -> np.ndarray:
    """Euler steps without friction, velocities first, with dashpots at the start or at the end of the step."""
    chain, dt = lane.chain, lane.time_step
    mass, damping = chain.mass_matrix, chain.damping_matrix
    # Drake's matrix is of joint coordinates, but (M + δt C) is the same form in any coordinates.
    left = np.linalg.inv(mass + dt * damping * implicit)
    position, velocity = state.positions[0], state.velocities[0]
    rows = []
    for load in lane.loads(0, steps):
        force = -chain.stiffness_matrix @ position - damping @ velocity
        force[0] += load
        velocity = velocity + dt * left @ force
        position = position + dt * velocity
        rows.append(position)
    return np.array(rows)


def test_without_friction_and_dashpots_drake_takes_the_step_of_the_scheme() -> None:
    """Velocities first, then positions, with springs and load at the start of the step."""
    lane, state = lane_of(0.0, damping_ratio=0.0), random_state()
    expected = scheme(lane, state, STEPS)[0]
    np.testing.assert_allclose(run(lane, state, STEPS).positions, expected, rtol=0, atol=1e-12 * AMPLITUDE)


def test_dashpots_of_joints_act_with_the_velocity_at_the_end_of_the_step() -> None:
    """So that the tuned preset does not share the reference's scheme."""
    uneven = uneven_lane()
    chain = dataclasses.replace(uneven.chain, normal_force=np.zeros(7))
    lane, state = dataclasses.replace(uneven, chain=chain), random_state()
    motion = run(lane, state, STEPS).positions
    np.testing.assert_allclose(motion, linear_scheme(lane, state, STEPS, implicit=True), rtol=0, atol=1e-12 * AMPLITUDE)
    explicit = linear_scheme(lane, state, STEPS, implicit=False)
    assert np.max(np.abs(motion - explicit)) > 1e-3 * AMPLITUDE


def test_beyond_drakes_own_limit_every_gain_acts_alike() -> None:
    lane, state = lane_of(), random_state()
    ends = [built_with(Drake(), lane, d=gain).advance(state, 0, STEPS).positions for gain in (1e5, 1e6, 1e9)]
    assert np.array_equal(ends[0], ends[1])
    assert np.array_equal(ends[1], ends[2])


def test_a_weak_gain_lets_a_stuck_contact_creep_with_the_force_over_the_gain() -> None:
    lane = lane_of(5.0, 0.3)
    trajectory = built_with(Drake(), lane, d=100.0).run(State.at_rest(1, 7), 0, STEPS)[0]
    gain = 100.0 * 0.5 / lane.time_step
    np.testing.assert_allclose(trajectory.relative_velocity, -trajectory.friction / gain, rtol=1e-6, atol=1e-14)
    tuned = run(lane, State.at_rest(1, 7), STEPS)
    speed = np.max(np.abs(trajectory.relative_velocity))
    assert np.max(np.abs(tuned.relative_velocity)) < 0.02 * speed


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


@both_formulations
def test_forces_kept_from_the_step_before_are_those_of_the_step_that_begins(formulation: str) -> None:
    """Drake keeps outputs until the next step unless told otherwise: the rows have to be taken one later."""
    lane, state = uneven_lane(), random_state()
    live = run(lane, state, STEPS, formulation)
    kept = built_with(Drake(), lane, formulation, **{"output ports": "sampled"}).run(state, 0, STEPS)[0]
    assert np.array_equal(live.positions, kept.positions)
    assert np.array_equal(live.friction, kept.friction)


@pytest.mark.parametrize("frequency_ratio", [0.23, 0.71, 1.37, 1.91])
def test_no_step_is_lost_or_taken_twice_with_time_in_seconds(frequency_ratio: float) -> None:
    """Drake counts steps by their times; those are no whole numbers in SI units."""
    lane = lane_of(0.0, frequency_ratio)
    trajectory = run(lane, State.at_rest(1, 7), 5000, preset="default")
    expected = linear_scheme(lane, State.at_rest(1, 7), 5000, implicit=True)
    assert trajectory.positions.shape == expected.shape
    np.testing.assert_allclose(trajectory.positions, expected, rtol=0, atol=1e-9 * AMPLITUDE)


def test_default_creeps_by_three_millimetres_a_second_at_three_newtons() -> None:
    """F / d with the d that one would write, at every time step."""
    lane = lane_of(5.0)
    motion = run(lane, State.at_rest(1, 7), 2 * STEPS, preset="default")
    stuck = np.abs(motion.friction) < 0.999 * lane.chain.friction_bound
    assert stuck.all()
    np.testing.assert_allclose(motion.relative_velocity, -motion.friction / 1e3, rtol=1e-6, atol=1e-12)


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


def test_without_dissipation_both_gliding_approximations_are_nearly_one() -> None:
    lane = lane_of(0.3, 0.6)
    sap, similar, tuned = (
        run(lane, State.at_rest(1, 7), 2 * STEPS, "contact", preset).positions for preset in ("sap", "similar", "tuned")
    )
    assert np.max(np.abs(sap - similar)) < 0.1 * np.max(np.abs(sap - tuned))


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


def test_a_stuck_default_contact_creeps_by_drakes_stiction_tolerance() -> None:
    """λ_T = −F v / √(v² + v_s²), at every time step."""
    lane = lane_of(5.0)
    motion = run(lane, State.at_rest(1, 7), 2 * STEPS, "contact", "default")
    slip = motion.relative_velocity
    expected = -lane.chain.friction_bound * slip / np.hypot(slip, 1e-3)
    np.testing.assert_allclose(motion.friction, expected, rtol=1e-5, atol=1e-6 * lane.chain.friction_bound[0])
    assert np.max(np.abs(slip)) > 1e-4


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


@gliding
def test_a_sphere_that_has_left_its_plane_moves_as_the_law_says(preset: str) -> None:
    """Drake finds contacts at the start of a step: a sphere that lands within one is free until its end."""
    variant = Variant("drake", "contact", preset)
    law, lane = law_of(variant.preset), lane_of(0.1, 0.7)
    assert law is not None
    model = law.build([lane])
    state = model.advance(State.at_rest(1, 7), 0, 10 * STEPS)
    expected, found = (simulation.run(state, 0, STEPS)[0] for simulation in (model, variant.build([lane])))
    assert np.any(found.normal_force == 0), "no sphere leaves its plane"
    assert np.max(np.abs(found.positions - expected.positions)) < law.period_bound * AMPLITUDE


def test_a_gain_without_one_in_newtons_is_that_of_the_reduced_mass_over_the_step() -> None:
    chain = Chain.from_ratios(cells=2, outer_mass_ratio=[1.0, 2.0], friction_ratio=0.3)
    preset = Variant("drake").preset
    gains = actuator_gains(chain, 0.01, preset)
    assert gains == pytest.approx(preset["d"] * np.array([0.5, 1.0]) / 0.01)


def test_a_script_has_spheres_that_are_pressed_in_by_the_depth_of_the_preset() -> None:
    lane, preset = lane_of(0.3, cells=2), Variant("drake", "contact").preset
    stiffness = script_numbers(lane, preset, State.at_rest(1, 2))["stiffness"]
    assert stiffness / 2 * preset["depth"] * contact_scale(lane) == pytest.approx(lane.chain.normal_force)
