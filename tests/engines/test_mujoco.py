"""MuJoCo: the traps of its friction, its options and its units, against the scheme written out in matrices."""

import dataclasses
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from engines.interface import Formulation, Option, Preset
from engines.mujoco import MuJoCo
from reference_lcp.chain import Chain
from reference_lcp.drive import HarmonicBase
from reference_lcp.simulation import Lane
from reference_lcp.trajectory import State, Trajectory
from reference_lcp.validation import ParameterError

pytestmark = pytest.mark.skipif(MuJoCo().why_not_installed() is not None, reason="mujoco is not installed")

AMPLITUDE = 0.01
STEPS = 400
ROUND_OFF = 1e-12
"""Largest difference from the scheme over U0: both do the same arithmetic, in another order."""


both_formulations = pytest.mark.parametrize("formulation", ["joint", "contact"])


def lane_of(friction_ratio: float = 0.3, frequency_ratio: float = 0.6, **ratios: object) -> Lane:
    chain = Chain.from_ratios(friction_ratio=friction_ratio, base_amplitude=AMPLITUDE, **ratios)
    return Lane.periodic(chain, HarmonicBase.from_ratio(chain, frequency_ratio, AMPLITUDE), STEPS)


def uneven_lane() -> Lane:
    """Every cell differs, one has no friction, and the inner dashpots are strong."""
    rng = np.random.default_rng(7)
    return lane_of(
        np.array([0.3, 0.1, 0.0, 0.5, 0.2, 1.0, 0.05]),
        mass_ratio=rng.uniform(0.3, 2.0, 7),
        stiffness_ratio=rng.uniform(0.3, 2.0, 7),
        damping_ratio=rng.uniform(0.0, 0.1, 7),
        inner_damping_ratio=rng.uniform(0.0, 0.3, 7),
    )


def random_state(lanes: int = 1, size: float = 1.0) -> State:
    rng = np.random.default_rng(3)
    return State(size * AMPLITUDE * rng.normal(size=(lanes, 14)), 10 * size * AMPLITUDE * rng.normal(size=(lanes, 14)))


def scheme(lane: Lane, state: State, steps: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Equation (5) in matrices, with the closed solution of each contact; gives positions, velocities, friction."""
    chain, dt = lane.chain, lane.time_step
    masses, directions = np.diag(chain.mass_matrix), chain.contact_directions
    delassus = 1 / chain.outer_mass + 1 / chain.inner_mass
    position, velocity = state.positions[0], state.velocities[0]
    rows = []
    for load in lane.loads(0, steps):
        force = -chain.stiffness_matrix @ position - chain.damping_matrix @ velocity
        force[0] += load
        free = velocity + dt * force / masses
        bound = chain.friction_bound * dt
        impulse = np.clip(-(directions.T @ free) / delassus, -bound, bound)
        velocity = free + directions @ impulse / masses
        position = position + dt * velocity
        rows.append((position, velocity, impulse / dt))
    positions, velocities, friction = (np.array(column) for column in zip(*rows, strict=True))
    return positions, velocities, friction


def assert_equals_scheme(lane: Lane, state: State, trajectory: Trajectory, scale: float = AMPLITUDE) -> None:
    positions, velocities, friction = scheme(lane, state, trajectory.steps)
    speed = scale * lane.chain.resonator_frequency
    force = scale * np.max(lane.chain.stiffness_matrix)
    np.testing.assert_allclose(trajectory.positions, positions, rtol=0, atol=ROUND_OFF * scale)
    np.testing.assert_allclose(trajectory.velocities, velocities, rtol=0, atol=ROUND_OFF * speed)
    # A force is a difference of velocities over dt, which costs it the digits of dt times the frequency.
    np.testing.assert_allclose(trajectory.friction, friction, rtol=0, atol=100 * ROUND_OFF * force)


def run(lane: Lane, state: State, steps: int, formulation: str = "joint") -> Trajectory:
    simulation = MuJoCo().build([lane], formulation)
    trajectory = simulation.run(state, 0, steps)[0]
    simulation.close()
    return trajectory


@both_formulations
@pytest.mark.parametrize("friction_ratio", [0.0, 0.1, 0.3, 0.6, 1.0, 5.0])
def test_motion_and_friction_equal_the_scheme_from_frictionless_to_locked(
    friction_ratio: float, formulation: str
) -> None:
    """Motors left on, a bound times the wrong step, a damping of the engine's own: each would show here."""
    lane = lane_of(friction_ratio)
    state = random_state(size=0.3)
    assert_equals_scheme(lane, state, run(lane, state, STEPS, formulation))


@both_formulations
def test_uneven_cells_and_inner_dashpots_equal_the_scheme(formulation: str) -> None:
    lane = uneven_lane()
    assert_equals_scheme(lane, random_state(), run(lane, random_state(), 2 * STEPS, formulation))


def test_lanes_of_one_batch_keep_their_own_chain_drive_and_time_step() -> None:
    lanes = [lane_of(0.0, 0.3), uneven_lane(), lane_of(1.0, 1.3)]
    states = random_state(3)
    simulation = MuJoCo().build(lanes)
    for index, trajectory in enumerate(simulation.run(states, 0, STEPS)):
        assert_equals_scheme(lanes[index], states.subset([index]), trajectory)


def test_two_halves_equal_the_whole() -> None:
    simulation = MuJoCo().build([lane_of(), uneven_lane()])
    whole = simulation.advance(random_state(2), 0, 200)
    half = simulation.advance(random_state(2), 0, 100)
    halves = simulation.advance(half, 100, 100)
    tolerance = MuJoCo().preset("joint", "tuned").split_tolerance * AMPLITUDE
    np.testing.assert_allclose(halves.positions, whole.positions, rtol=0, atol=tolerance)


@both_formulations
def test_nothing_is_remembered_between_runs(formulation: str) -> None:
    simulation = MuJoCo().build([lane_of(), uneven_lane()], formulation)
    first = simulation.run(random_state(2), 0, STEPS)
    simulation.run(State.at_rest(2, 7), 50, 77)
    again = simulation.run(random_state(2), 0, STEPS)
    fresh = MuJoCo().build(simulation.lanes, formulation).run(random_state(2), 0, STEPS)
    for one, two, three in zip(first, again, fresh, strict=True):
        for name in ("positions", "velocities", "friction"):
            assert np.array_equal(getattr(one, name), getattr(two, name))
            assert np.array_equal(getattr(one, name), getattr(three, name))


def test_advance_and_subset_repeat_run_bit_by_bit() -> None:
    simulation = MuJoCo().build([lane_of(), uneven_lane(), lane_of(1.0)])
    states = random_state(3)
    rows = np.array([trajectory.positions[-1] for trajectory in simulation.run(states, 0, STEPS)])
    assert np.array_equal(simulation.advance(states, 0, STEPS).positions, rows)
    chosen = simulation.subset([2, 0])
    assert np.array_equal(chosen.advance(states.subset([2, 0]), 0, STEPS).positions, rows[[2, 0]])


def test_friction_stays_within_its_bound_and_never_feeds_energy() -> None:
    lane = uneven_lane()
    trajectory = run(lane, random_state(), 2 * STEPS)
    bound = lane.chain.friction_bound
    speed = np.max(np.abs(trajectory.relative_velocity))
    assert np.all(np.abs(trajectory.friction) <= bound * (1 + 1e-9))
    assert np.all(trajectory.friction * trajectory.relative_velocity <= 1e-12 * bound.max() * speed)


def test_a_stuck_contact_does_not_creep() -> None:
    lane = lane_of(5.0, 0.3)
    trajectory = run(lane, State.at_rest(1, 7), 3 * STEPS)
    assert np.max(np.abs(trajectory.relative_velocity)) <= 1e-13 * AMPLITUDE * lane.drive.angular_frequency
    assert np.max(np.abs(trajectory.inner_positions - trajectory.outer_positions)) <= 1e-12 * AMPLITUDE


@both_formulations
@pytest.mark.parametrize(("mass", "stiffness", "length"), [(1e-15, 1e6, 1e-9), (1e9, 1e3, 100.0), (1e-3, 1e15, 1e-6)])
def test_units_do_not_matter(mass: float, stiffness: float, length: float, formulation: str) -> None:
    """Nanometres at gigahertz pass the engine's built-in numbers in SI units, and must not here."""
    chain = Chain.from_ratios(friction_ratio=0.3, outer_mass=mass, chain_stiffness=stiffness, base_amplitude=length)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.6, length), STEPS)
    positions = scheme(lane, State.at_rest(1, 7), STEPS)[0]
    trajectory = run(lane, State.at_rest(1, 7), STEPS, formulation)
    np.testing.assert_allclose(trajectory.positions, positions, rtol=0, atol=ROUND_OFF * length)


def test_motion_far_above_the_displacement_scale_is_not_cut_off() -> None:
    lane, state = lane_of(), random_state(size=1e4)
    assert_equals_scheme(lane, state, run(lane, state, STEPS), scale=1e4 * AMPLITUDE)


def test_it_is_silent_writes_nothing_and_survives_divergence(tmp_path: Path) -> None:
    """Standard output and error are read as file descriptors: compiled code does not write to sys.stderr."""
    program = (
        "import sys, numpy as np; from engines.mujoco import MuJoCo; assert 'mujoco' not in sys.modules\n"
        "from reference_lcp.chain import Chain; from reference_lcp.drive import HarmonicBase\n"
        "from reference_lcp.simulation import Lane; from reference_lcp.trajectory import State\n"
        "chain = Chain.from_ratios(friction_ratio=0.1)\n"
        "unstable = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.1), 20)\n"
        "end = MuJoCo().build([unstable]).advance(State.at_rest(1, 7), 0, 400)\n"
        "assert np.max(np.abs(end.positions)) > 1e6 * 0.01\n"
    )
    root = str(Path(__file__).parents[2])
    done = subprocess.run(
        [sys.executable, "-B", "-c", program],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": root},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert list(tmp_path.iterdir()) == []


def test_states_of_a_wrong_shape_are_refused() -> None:
    simulation = MuJoCo().build([lane_of()])
    with pytest.raises(ParameterError, match=r"shape \(1, 6\)"):
        simulation.run(State.at_rest(1, 3), 0, 1)


def test_states_where_mujoco_would_stop_are_refused() -> None:
    simulation = MuJoCo().build([lane_of()])
    with pytest.raises(ParameterError, match=r"initial positions reach 1e\+12"):
        simulation.advance(State(np.full((1, 14), 1e12), np.zeros((1, 14))), 0, 1)


def test_a_diverged_run_leaves_nothing_behind() -> None:
    chain = Chain.from_ratios(friction_ratio=0.1)
    unstable = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.1), 20)
    simulation = MuJoCo().build([unstable])
    before = simulation.advance(State.at_rest(1, 7), 0, 3).positions
    simulation.advance(State.at_rest(1, 7), 0, 100)
    assert np.array_equal(simulation.advance(State.at_rest(1, 7), 0, 3).positions, before)


def test_without_the_no_slip_sweep_a_stuck_contact_creeps() -> None:
    """The option that removes MuJoCo's softness is needed: the law itself is regularised."""
    tuned = MuJoCo().preset("joint", "tuned")
    soft = Preset("", {**tuned.options, "noslip_iterations": Option(0, 0, "")})
    simulation = MuJoCo()._build((lane_of(5.0, 0.3),), Formulation.JOINT, soft)
    trajectory = simulation.run(State.at_rest(1, 7), 0, STEPS)[0]
    assert np.max(np.abs(trajectory.relative_velocity)) > 1e-6 * AMPLITUDE


def with_coefficients(coefficient: object) -> Lane:
    """The canonical chain with these coefficients of friction, and the same bounds."""
    lane = lane_of()
    coefficients = np.broadcast_to(coefficient, 7).astype(float)
    bound = lane.chain.friction_bound
    chain = dataclasses.replace(lane.chain, friction_coefficient=coefficients, normal_force=bound / coefficients)
    return dataclasses.replace(lane, chain=chain)


@pytest.mark.parametrize("coefficient", [0.001, 0.1, 3.0, [0.5, 0.05, 0.3, 1.0, 0.02, 2.0, 0.7]])
def test_only_the_bound_enters_the_motion_whatever_the_coefficient(coefficient: object) -> None:
    lane, state = with_coefficients(coefficient), random_state()
    trajectory = run(lane, state, STEPS, "contact")
    assert_equals_scheme(lane, state, trajectory)
    assert trajectory.normal_force == pytest.approx(np.broadcast_to(lane.chain.normal_force, (STEPS, 7)), rel=1e-9)


@pytest.mark.parametrize("coefficient", [1e-5, [0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.004]])
def test_coefficients_that_mujoco_would_cut_off_or_take_for_singular_are_refused(coefficient: object) -> None:
    with pytest.raises(ParameterError, match=r"friction_coefficient = .* at least"):
        MuJoCo().build([with_coefficients(coefficient)], "contact")


def test_in_other_units_the_sweep_over_sliding_contacts_is_inexact() -> None:
    """MuJoCo solves for them to a fixed 1e-10: the units of the contact formulation are needed."""
    tuned = MuJoCo().preset("contact", "tuned")
    coarse = Preset("", {**tuned.options, "units": Option("lane", "SI", "")})
    lane, state = with_coefficients(3.0), random_state()
    simulation = MuJoCo()._build((lane,), Formulation.CONTACT, coarse)
    difference = simulation.run(state, 0, STEPS)[0].positions - scheme(lane, state, STEPS)[0]
    assert np.max(np.abs(difference)) > 1e-8 * AMPLITUDE


@both_formulations
def test_a_default_contact_creeps_and_a_finer_step_does_not_help(formulation: str) -> None:
    """A time constant of 0.02 s, whatever the step: friction never stops a contact."""
    creep = []
    for steps in (STEPS, 4 * STEPS):
        coarse = lane_of(5.0)
        lane = Lane.periodic(coarse.chain, coarse.drive, steps)
        trajectory = MuJoCo().build([lane], formulation, "default").run(State.at_rest(1, 7), 0, 2 * steps)[0]
        creep.append(np.max(np.abs(trajectory.relative_velocity)) / (AMPLITUDE * lane.drive.angular_frequency))
    assert creep[0] > 0.01
    assert creep[1] == pytest.approx(creep[0], rel=0.1)


def test_in_the_default_pyramid_friction_presses_the_contact() -> None:
    lane = lane_of(0.3, 0.9)
    trajectory = MuJoCo().build([lane], "contact", "default").run(State.at_rest(1, 7), 0, STEPS)[0]
    assert np.max(trajectory.normal_force / lane.chain.normal_force) > 1.5
