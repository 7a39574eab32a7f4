"""ODE: its motors, its contacts and its own springs, and where its Python binding or its defaults mislead."""

import sys

import numpy as np
import pytest

from engines.interface.variant import Variant, variants_named
from engines.ode import INSTALLATION, ODE
from engines.ode.presets import BOUNCE
from reference_lcp.chain.drives import StillBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from tests.engines.scheme_oracle import (
    AMPLITUDE,
    ROUND_OFF,
    STEPS,
    assert_equals_scheme,
    bounded_impulses,
    built_with,
    lane_of,
    random_state,
    scheme,
    uneven_lane,
)
from tests.installed import each_variant

pytestmark = pytest.mark.needs("ode")

both_formulations = pytest.mark.parametrize("formulation", ["joint", "contact"])


def run(
    lane: Lane, state: State, steps: int = STEPS, formulation: str = "joint", preset: str = "tuned", **options: object
) -> Trajectory:
    return built_with(ODE(), lane, formulation, preset, **options).run(state, 0, steps)[0]


def implicit_euler(lane: Lane, state: State, steps: int) -> np.ndarray:
    """Springs and dashpots at the end of a step, bounded impulses by projected Gauss–Seidel; gives positions."""
    chain, dt, directions = lane.chain, lane.time_step, lane.chain.contact_directions
    effective = chain.mass_matrix + dt * chain.damping_matrix + dt**2 * chain.stiffness_matrix
    inverse = np.linalg.inv(effective)
    delassus = directions.T @ inverse @ directions
    position, velocity, impulse = state.positions[0], state.velocities[0], np.zeros(chain.cells)
    rows = []
    for load in lane.loads(0, steps):
        force = -chain.stiffness_matrix @ position
        force[0] += load
        free = inverse @ (chain.mass_matrix @ velocity + dt * force)
        slip = directions.T @ free
        bounded_impulses(impulse, delassus, slip, chain.friction_bound * dt)
        velocity = free + inverse @ directions @ impulse
        position = position + dt * velocity
        rows.append(position)
    return np.array(rows)


@both_formulations
@pytest.mark.parametrize("friction_ratio", [0.0, 0.1, 0.3, 1.0, 5.0])
def test_motion_equals_the_scheme_from_frictionless_to_locked(friction_ratio: float, formulation: str) -> None:
    lane, state = lane_of(friction_ratio), random_state(size=0.3)
    assert_equals_scheme(lane, state, run(lane, state, formulation=formulation))


@both_formulations
def test_uneven_cells_and_inner_dashpots_equal_the_scheme(formulation: str) -> None:
    lane = uneven_lane()
    assert_equals_scheme(lane, random_state(), run(lane, random_state(), 2 * STEPS, formulation))


def test_the_binding_names_another_parameter_for_the_largest_force() -> None:
    """In ODE 0.16 a new number came before it: what pyode calls FMax is the lowest velocity, and nothing rubs."""
    lane, state = lane_of(), random_state()
    without = run(lane, state, 50, fmax=3)
    assert np.all(without.friction == 0)
    frictionless = scheme(lane_of(0.0), state, 50)[0]
    np.testing.assert_allclose(without.positions, frictionless, rtol=0, atol=ROUND_OFF * AMPLITUDE)


def test_soft_constraints_make_a_stuck_contact_creep_and_hard_ones_do_not() -> None:
    lane = lane_of(5.0, 0.3)
    speed = AMPLITUDE * lane.drive.angular_frequency
    soft, hard = (run(lane, State.at_rest(1, 7), 3 * STEPS, units="SI", cfm=cfm) for cfm in (1e-10, 0.0))
    assert 1e-11 < np.max(np.abs(soft.relative_velocity)) / speed < 1e-6
    assert np.max(np.abs(hard.relative_velocity)) / speed <= 1e-13
    assert np.max(np.abs(hard.inner_positions - hard.outer_positions)) <= 1e-12 * AMPLITUDE


def test_own_springs_are_implicit_euler_with_exact_friction() -> None:
    lane, state = uneven_lane(), random_state()
    motion = run(lane, state, 200, preset="stops")
    np.testing.assert_allclose(motion.positions, implicit_euler(lane, state, 200), rtol=0, atol=1e-7 * AMPLITUDE)


@pytest.mark.parametrize("preset", ["tuned", "default", "stops"])
def test_a_motor_without_force_reports_no_friction(preset: str) -> None:
    """ODE leaves the record of such a motor as it was allocated."""
    motion = run(uneven_lane(), random_state(), 50, preset=preset)
    assert np.all(motion.friction[:, 2] == 0)
    assert np.all(np.any(np.delete(motion.friction, 2, axis=1) != 0, axis=0))


def test_own_springs_take_energy_out_that_no_dashpot_takes() -> None:
    """Implicit Euler damps: a decibel and more where the scheme errs by a hundredth."""
    chain = Chain.from_ratios(damping_ratio=0.0)
    lane = Lane(chain, StillBase(AMPLITUDE), 2e-3)
    state = random_state()
    own, forces = (run(lane, state, 2000, preset=one) for one in ("stops", "default"))
    energy = [
        np.einsum("i,ij,j", one.positions[-1], chain.stiffness_matrix, one.positions[-1])
        + np.einsum("i,ij,j", one.velocities[-1], chain.mass_matrix, one.velocities[-1])
        for one in (own, forces)
    ]
    assert energy[0] < 0.5 * energy[1]


@pytest.mark.parametrize("mode", [BOUNCE, 0x1000])
def test_in_a_contact_mu_is_a_force_unless_the_mode_says_otherwise(mode: int) -> None:
    """ODE's default takes mu = 0.5 for half a newton, and so does `ContactApprox1_1`: the slip is along direction 2."""
    lane, state = lane_of(0.3), random_state()
    assert lane.chain.friction_bound == pytest.approx(3.0)
    motion = run(lane, state, 50, "contact", units="SI", mode=mode)
    assert np.max(np.abs(motion.friction)) == pytest.approx(0.5, rel=1e-6)
    assert np.max(motion.normal_force) == pytest.approx(6.0, rel=1e-6)


@pytest.mark.parametrize("inertia", [2.0**20, 2.0**60])
def test_redundant_points_of_a_hard_contact_give_a_wrong_motion_without_a_word(inertia: float) -> None:
    lane, state = lane_of(0.3, 0.9), State.at_rest(1, 7)
    motion = run(lane, state, 10 * STEPS, "contact", shape="box", inertia=inertia)
    assert np.max(np.abs(motion.positions - scheme(lane, state, 10 * STEPS)[0])) > 0.05 * AMPLITUDE


def test_a_contact_outside_the_surface_layer_is_pushed_out() -> None:
    lane, state = lane_of(), State.at_rest(1, 7)
    pushed, left = (
        run(lane, state, 5, "contact", surface_layer=layer).normal_force / lane.chain.normal_force
        for layer in (0.0, 2.0**-10)
    )
    assert np.max(np.abs(pushed - 1)) > 1e-3
    assert np.max(np.abs(left - 1)) < 1e-12


@both_formulations
def test_motion_far_above_the_displacement_scale_is_not_cut_off(formulation: str) -> None:
    lane, state = lane_of(), random_state(size=1e4)
    assert_equals_scheme(lane, state, run(lane, state, formulation=formulation), scale=1e4 * AMPLITUDE)


@pytest.mark.parametrize(
    "one", each_variant(variants_named(["ode", "ode:joint:stops", "ode:contact", "siconos", "siconos:contact"]))
)
def test_the_bare_engine_steps_in_every_formulation(one: Variant) -> None:
    simulation = one.build([lane_of()])
    before = simulation.advance(random_state(), 0, 10)
    simulation.models[0].native_steps(20)
    assert np.array_equal(simulation.advance(random_state(), 0, 10).positions, before.positions)


def test_a_python_without_ode_is_a_reason_with_a_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MULTIBODY_XVAL_ODE_PYTHON", sys.executable)
    reason = ODE().unavailable_reason()
    INSTALLATION.process().close()
    assert reason is not None
    assert "No module named 'ode'; apt install python3-pyode, or let MULTIBODY_XVAL_ODE_PYTHON" in reason


def test_the_version_is_that_of_the_library() -> None:
    assert ODE().version().startswith("0.16")
