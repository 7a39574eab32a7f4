"""Siconos: its θ-scheme, its relays and contacts, and where it says nothing of what goes wrong."""

import dataclasses
import itertools
import re
import sys

import numpy as np
import pytest

from engines.isolated.process import EngineProcessError
from engines.siconos import INSTALLATION, Siconos
from reference_lcp.chain.drives import HarmonicBase, StillBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.schemes.euler import CompiledSimulation
from reference_lcp.steady.orbits import periodic_orbits
from tests.engines.scheme_oracle import (
    AMPLITUDE,
    ROUND_OFF,
    STEPS,
    assert_equals_scheme,
    bounded_impulses,
    built_with,
    lane_of,
    random_state,
    uneven_lane,
)

pytestmark = pytest.mark.needs("siconos")


def run(lane: Lane, state: State, steps: int = STEPS, preset: str = "tuned", formulation: str = "joint") -> Trajectory:
    return Siconos().build([lane], formulation, preset).run(state, 0, steps)[0]


def run_changed(
    lane: Lane, state: State, formulation: str = "joint", preset: str = "tuned", **options: object
) -> Trajectory:
    return built_with(Siconos(), lane, formulation, preset, **options).run(state, 0, STEPS)[0]


def trapezoidal_rule(lane: Lane, state: State, steps: int) -> np.ndarray:
    """Moreau–Jean with θ = ½ written out: projected Gauss–Seidel over the bounded impulses; gives positions."""
    chain, dt, directions = lane.chain, lane.time_step, lane.chain.contact_directions
    effective = chain.mass_matrix + dt / 2 * chain.damping_matrix + dt**2 / 4 * chain.stiffness_matrix
    inverse = np.linalg.inv(effective)
    delassus = directions.T @ inverse @ directions
    loads = lane.loads(0, steps + 1)
    position, velocity = state.positions[0], state.velocities[0]
    impulse = np.zeros(chain.cells)
    rows = []
    for before, after in itertools.pairwise(loads):
        force = -chain.stiffness_matrix @ (position + dt / 2 * velocity) - chain.damping_matrix @ velocity
        force[0] += (before + after) / 2
        free = velocity + inverse @ (dt * force)
        slip = directions.T @ free
        bounded_impulses(impulse, delassus, slip, chain.friction_bound * dt)
        new = free + inverse @ directions @ impulse
        position, velocity = position + dt / 2 * (velocity + new), new
        rows.append(position)
    return np.array(rows)


@pytest.mark.parametrize(("formulation", "tolerance"), [("joint", ROUND_OFF), ("contact", 1e-11)])
def test_tuned_is_the_trapezoidal_rule_with_exact_friction(formulation: str, tolerance: float) -> None:
    """Uneven cells, one without friction, in one relay for each bound."""
    lane, state = uneven_lane(), random_state()
    motion = run(lane, state, 200, formulation=formulation)
    expected = trapezoidal_rule(lane, state, 200)
    np.testing.assert_allclose(motion.positions, expected, rtol=0, atol=tolerance * AMPLITUDE)


@pytest.mark.parametrize("friction_ratio", [0.0, 0.1, 0.3, 1.0, 5.0])
def test_euler_equals_the_scheme_from_frictionless_to_locked(friction_ratio: float) -> None:
    lane, state = lane_of(friction_ratio), random_state(size=0.3)
    assert_equals_scheme(lane, state, run(lane, state, preset="euler"))


def test_euler_equals_the_scheme_on_uneven_cells_over_forty_periods() -> None:
    lane, state = uneven_lane(), random_state()
    assert_equals_scheme(lane, state, run(lane, state, 40 * STEPS, preset="euler"))


def test_a_relay_is_idle_while_the_inner_mass_is_ahead_unless_it_starts_deep_below() -> None:
    """Siconos takes the relation for a gap: without the offset half of the friction is lost, without a word."""
    lane = lane_of(0.3)
    ahead = State(np.concatenate([np.zeros(7), np.full(7, AMPLITUDE)])[None], np.zeros((1, 14)))
    idle = run_changed(lane, ahead, activation="gap <= 0").friction[:5]
    assert np.all(idle == 0)
    assert np.all(np.abs(run(lane, ahead, 5).friction) > 0)


def test_a_motion_far_above_the_displacement_scale_keeps_its_friction() -> None:
    lane, state = lane_of(), random_state(size=1e4)
    assert_equals_scheme(lane, state, run(lane, state, preset="euler"), scale=1e4 * AMPLITUDE)


@pytest.mark.parametrize("preset", ["tuned", "euler", "default"])
def test_the_bound_is_a_force_whatever_the_step(preset: str) -> None:
    """Siconos takes bounds of an impulse."""
    for steps in (STEPS, 4 * STEPS):
        lane = dataclasses.replace(lane_of(0.1), time_step=lane_of(0.1).drive.period / steps)
        largest = np.max(np.abs(run(lane, random_state(), 50, preset).friction), axis=0)
        assert largest == pytest.approx(lane.chain.friction_bound, rel=1e-9)


def test_the_drive_reaches_the_chain() -> None:
    """Siconos copies the array of forces that it is given: writing into that one moves nothing."""
    lane = lane_of()
    driven = run(lane, State.at_rest(1, 7), 50)
    still = run(dataclasses.replace(lane, drive=StillBase(AMPLITUDE)), State.at_rest(1, 7), 50)
    assert np.max(np.abs(still.positions)) < 1e-15 * AMPLITUDE
    assert np.max(np.abs(driven.positions)) > 1e-3 * AMPLITUDE


@pytest.mark.parametrize("preset", ["tuned", "euler", "default"])
def test_a_stuck_contact_does_not_creep(preset: str) -> None:
    lane = lane_of(5.0, 0.3)
    motion = run(lane, State.at_rest(1, 7), 3 * STEPS, preset)
    assert np.max(np.abs(motion.relative_velocity)) <= 1e-13 * AMPLITUDE * lane.drive.angular_frequency
    assert np.max(np.abs(motion.inner_positions - motion.outer_positions)) <= 1e-12 * AMPLITUDE


def test_the_default_solver_and_a_relay_for_each_contact_give_the_same() -> None:
    lane, state = uneven_lane(), random_state()
    motion = run_changed(lane, state, solver="AVI_CAOFERRIS", interactions="one a contact", newton="nonlinear")
    np.testing.assert_allclose(motion.positions, run(lane, state).positions, rtol=0, atol=ROUND_OFF * AMPLITUDE)


@pytest.mark.parametrize("solver", ["PATH", "PGS"])
def test_a_solver_that_fails_is_reported(solver: str) -> None:
    """Siconos at most prints a warning: PATH is not built in, and PGS stops far too early."""
    with pytest.raises(
        EngineProcessError, match=rf"the solver {re.escape(solver)} failed: friction of cell \d in step \d+ breaks"
    ):
        run_changed(uneven_lane(), random_state(), solver=solver)


def test_contacts_move_as_relays_do_and_press_with_what_is_given() -> None:
    lane, state = uneven_lane(), random_state()
    joint, contact = (run(lane, state, formulation=one) for one in ("joint", "contact"))
    np.testing.assert_allclose(contact.positions, joint.positions, rtol=0, atol=1e-11 * AMPLITUDE)
    assert contact.normal_force == pytest.approx(np.broadcast_to(lane.chain.normal_force, (STEPS, 7)), rel=1e-9)


def test_the_default_contact_solver_stops_early() -> None:
    """Visible, and small: a tolerance of 1e-4 on impulses that are themselves small numbers."""
    lane, state = lane_of(0.3, 0.9), State.at_rest(1, 7)
    default, tuned = (run(lane, state, preset=one, formulation="contact").positions for one in ("default", "tuned"))
    difference = np.max(np.abs(default - tuned)) / AMPLITUDE
    assert 1e-9 < difference < 1e-4


def test_without_a_threshold_lemke_parts_a_contact_and_presses_twice_in_the_next_step() -> None:
    lane, state = lane_of(0.3, 0.9), State.at_rest(1, 7)
    for threshold, worst in ((0.0, 0.9), (1e-6, 0.0)):
        motion = run_changed(lane, state, "contact", units="SI", solver="LEMKE", threshold=threshold)
        error = np.max(np.abs(motion.normal_force / lane.chain.normal_force - 1))
        assert worst <= error <= worst + 0.2


@pytest.mark.parametrize(("mass", "stiffness", "length"), [(1e-15, 1e6, 1e-9), (1e9, 1e3, 100.0), (1e-3, 1e15, 1e-6)])
@pytest.mark.parametrize("formulation", ["joint", "contact"])
def test_units_do_not_matter(mass: float, stiffness: float, length: float, formulation: str) -> None:
    chain = Chain.from_ratios(friction_ratio=0.3, outer_mass=mass, chain_stiffness=stiffness, base_amplitude=length)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.6, length), STEPS)
    motion, usual = (run(one, State.at_rest(1, 7), STEPS, formulation=formulation) for one in (lane, lane_of()))
    np.testing.assert_allclose(motion.positions / length, usual.positions / AMPLITUDE, rtol=0, atol=1e-11)


def test_a_python_without_siconos_is_a_reason_with_a_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MULTIBODY_XVAL_SICONOS_PYTHON", sys.executable)
    reason = Siconos().unavailable_reason()
    INSTALLATION.process().close()
    assert reason is not None
    assert "apt install python3-siconos" in reason
    assert "MULTIBODY_XVAL_SICONOS_PYTHON" in reason


def test_the_version_is_debians_and_not_that_of_the_next_release() -> None:
    assert Siconos().version().startswith("4.4")


def test_default_contacts_let_go_for_single_steps_and_a_threshold_above_round_off_holds_them() -> None:
    """Unequal cells over a period of their steady state: a contact that lets go has no normal force, no friction."""
    mass_ratio = [0.8374, 0.8888, 1.0881, 0.9612, 1.1257, 0.9023, 1.1914]
    friction_ratio = [0.2211, 0.3327, 0.2689, 0.3154, 0.2377, 0.3581, 0.2793]
    chain = Chain.from_ratios(mass_ratio=mass_ratio, friction_ratio=friction_ratio)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.6), STEPS)
    (orbit,) = periodic_orbits(CompiledSimulation([lane]), STEPS)
    default, held = (
        run_changed(lane, orbit.trajectory.end, "contact", "default", threshold=threshold).normal_force
        for threshold in (0.0, 1e-6)
    )
    assert 0 < np.sum(default == 0.0) < default.size / 100
    assert np.all(held > 0.0)
