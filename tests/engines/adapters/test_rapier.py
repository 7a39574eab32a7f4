"""Rapier: what only its substeps, its passes over contacts, its multibodies and single precision do."""

import numpy as np
import pytest

from multibody_xval.engines.interface.tolerances import SINGLE
from multibody_xval.engines.rapier.contact import RapierContactLane
from multibody_xval.engines.rapier.law import SINGLE_PRECISION_PERIOD
from reference_lcp.chain.drives import HarmonicForce
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from tests.engines.scheme_oracle import (
    AMPLITUDE,
    ROUNDINGS,
    STEPS,
    chain_of,
    distance,
    lane_of,
    off_the_law,
    random_state,
    run,
    scheme,
)

pytestmark = pytest.mark.needs("rapier")

formulations = pytest.mark.parametrize("formulation", ["joint", "contact"])


@pytest.mark.parametrize("iterations", [1, 2, 4, 8])
def test_iterations_of_the_solver_are_substeps_under_one_force(iterations: int) -> None:
    """From rest, n substeps under a force F lead to F dt² / m · n (n + 1) / (2 n²): Euler's step has the factor 1."""
    chain, start = Chain.from_ratios(friction_ratio=0.0), STEPS // 4
    lane = Lane.periodic(chain, HarmonicForce(3.0, 20.0), STEPS)
    motion = run("rapier", lane, State.at_rest(1, 7), 1, start, num_solver_iterations=iterations)
    euler = lane.loads(start, 1)[0] * lane.time_step**2 / chain.outer_mass[0]
    assert euler != 0
    assert motion.positions[0, 0] == pytest.approx((iterations + 1) / (2 * iterations) * euler, rel=10 * SINGLE)
    assert motion.velocities[0, 0] == pytest.approx(euler / lane.time_step, rel=10 * SINGLE)


@pytest.mark.parametrize(("warm", "missing"), [(0.0, 1.0), (1.0, 0.0)])
def test_contacts_by_default_move_by_the_friction_that_they_start_from(warm: float, missing: float) -> None:
    """Rapier finds friction after positions have moved: by none in a new world, but for contacts that start warm."""
    lane, sliding = lane_of(0.3), State(np.zeros((1, 14)), np.repeat([[0.0, 1.0]], 7, axis=1))
    motion = run("rapier:contact", lane, sliding, 1, friction_in_bias_pass=False, warmstart_coefficient=warm)
    positions, velocities, friction = scheme(lane, sliding, 1)
    assert np.all(friction[0] == -lane.chain.friction_bound)
    without = lane.time_step**2 * friction[0] / lane.chain.inner_mass
    np.testing.assert_allclose(motion.inner_positions[0], positions[0, 7:] - missing * without, rtol=10 * SINGLE)
    np.testing.assert_allclose(motion.velocities[0, 7:], velocities[0, 7:], rtol=10 * SINGLE)


def test_contact_that_can_slide_in_one_direction_only_has_no_friction(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rapier solves both directions of a contact's plane at once, and gives up in silence where one has no mass."""
    monkeypatch.setattr(RapierContactLane, "FREE_INNER", (True, False, True))
    motion = run("rapier:contact", lane_of(), random_state(), 50)
    assert np.all(motion.friction == 0)
    assert distance(lane_of(0.0), random_state(), motion) < ROUNDINGS


def test_the_simplified_friction_moves_the_same_and_reports_none() -> None:
    motion = run("rapier:contact", lane_of(), random_state(), friction_model="SIMPLIFIED")
    assert distance(lane_of(), random_state(), motion) < ROUNDINGS
    assert np.all(motion.friction == 0)


@formulations
@pytest.mark.parametrize("length", [1e-12, 1e-6, 1e-2])
def test_default_is_the_same_for_motions_of_any_smallness_in_si_units(length: float, formulation: str) -> None:
    """A sphere touches exactly, in whatever size: no absolute length of Rapier's has a part in the motion."""
    assert off_the_law(f"rapier:{formulation}:default", chain_of(1.0, 1e3, length)) < SINGLE_PRECISION_PERIOD


def test_motors_of_the_default_yield_in_heavy_and_stiff_chains_and_contacts_do_not() -> None:
    """A stuck contact slips at its friction over the motor's damping, which is the same number in every chain."""
    heavy = chain_of(1e6, 1e9, AMPLITUDE)
    assert off_the_law("rapier:joint:default", heavy) > 10 * SINGLE_PRECISION_PERIOD
    assert off_the_law("rapier:contact:default", heavy) < SINGLE_PRECISION_PERIOD


@formulations
def test_default_cuts_velocities_off(formulation: str) -> None:
    """At 400 m/s; of a contact, the velocity across that its pressing force makes in a substep is a part of it."""
    assert off_the_law(f"rapier:{formulation}:default", chain_of(1.0, 1e3, 100.0)) > 0.1


def test_friction_of_all_substeps_explains_the_momentum_of_inner_masses() -> None:
    """Of contacts; motors report the last substep, which differs where one starts or stops within a step."""
    lane = lane_of()
    motion = run("rapier:contact:default", lane, random_state())
    stiffness, damping = lane.chain.stiffness_matrix[7:], lane.chain.damping_matrix[7:]
    force = -motion.positions[:-1] @ stiffness.T - motion.velocities[:-1] @ damping.T
    gained = np.diff(motion.velocities[:, 7:], axis=0) * lane.chain.inner_mass / lane.time_step
    rounding = 10 * SINGLE * np.max(np.abs(motion.velocities)) * np.max(lane.chain.inner_mass) / lane.time_step
    np.testing.assert_allclose(motion.friction[1:], gained - force, rtol=0, atol=rounding)


@pytest.mark.parametrize("ratio", [1e-3, 1.0, 100.0])
def test_outer_masses_of_a_multibody_carry_inner_ones_up_to_a_hundred_times_as_heavy(ratio: float) -> None:
    lane, state = lane_of(mass_ratio=ratio), random_state()
    assert distance(lane, state, run("rapier:joint:native", lane, state)) < ROUNDINGS


def test_friction_of_a_multibody_is_the_bound_wherever_a_contact_slides() -> None:
    """It is read from slips."""
    motion, bound = run("rapier:joint:native", lane_of(), random_state()), lane_of().chain.friction_bound
    slides = np.abs(motion.relative_velocity) > 1e-3 * AMPLITUDE
    assert np.all(np.abs(motion.friction) <= bound)
    assert np.all((np.abs(motion.friction) == bound)[slides])


def test_four_iterations_of_a_multibody_are_the_substeps_of_motors() -> None:
    lane, four = chain_of(1.0, 1e3, AMPLITUDE), {"num_solver_iterations": 4, "units": "SI"}
    assert off_the_law("rapier:joint:default", lane, "rapier:joint:native", **four) < SINGLE_PRECISION_PERIOD
    assert off_the_law("rapier:joint:default", lane, "rapier:joint:native") > 1e-3
