"""Rapier: what only its substeps, its passes over contacts, its multibodies and single precision do."""

import numpy as np
import pytest

from multibody_xval.engines.interface.tolerances import SINGLE
from multibody_xval.engines.rapier.contact import RapierContactLane
from multibody_xval.engines.rapier.law import SINGLE_PRECISION_PERIOD
from tests.engines.scheme_oracle import (
    AMPLITUDE,
    ROUNDINGS,
    chain_of,
    distance,
    lane_of,
    off_the_law,
    random_state,
    run,
)

pytestmark = pytest.mark.needs("rapier")


def test_contact_that_can_slide_in_one_direction_only_has_no_friction_and_the_simplified_one_reports_none(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Rapier solves both directions of a contact's plane at once, and gives up in silence where one has no mass."""
    simplified = run("rapier:contact", lane_of(), random_state(), friction_model="SIMPLIFIED")
    monkeypatch.setattr(RapierContactLane, "FREE_INNER", (True, False, True))
    in_a_row = run("rapier:contact", lane_of(), random_state(), 50)
    for motion, friction_ratio in ((simplified, 0.3), (in_a_row, 0.0)):
        assert np.all(motion.friction == 0)
        assert distance(lane_of(friction_ratio), random_state(), motion) < ROUNDINGS


OFF_ITS_LAW = [
    *((f"rapier:{own}:default", (1.0, 1e3, length), False) for own in ("joint", "contact") for length in (1e-12, 1e-2)),
    ("rapier:contact:default", (1e6, 1e9, AMPLITUDE), False),
    # A stuck contact slips at its friction over the motor's damping, which is the same number in every chain.
    ("rapier:joint:default", (1e6, 1e9, AMPLITUDE), True),
    # Velocities are cut off at 400 m/s; of a contact, that across, of its pressing force in a substep, is a part of it.
    ("rapier:joint:default", (1.0, 1e3, 100.0), True),
    ("rapier:contact:default", (1.0, 1e3, 100.0), True),
]
"""Outer mass [kg], stiffness [N/m] and amplitude [m] of chains in SI units, and whether the default leaves its law."""


@pytest.mark.parametrize(("name", "units", "leaves"), OFF_ITS_LAW)
def test_default_is_the_same_in_small_chains_yields_in_heavy_and_stiff_ones_and_cuts_velocities_off(
    name, units, leaves
) -> None:
    """A sphere touches exactly, in whatever size: no absolute length of Rapier's has a part in the motion."""
    off = off_the_law(name, chain_of(*units))
    assert off > 10 * SINGLE_PRECISION_PERIOD if leaves else off < SINGLE_PRECISION_PERIOD


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


def test_four_iterations_of_a_multibody_are_the_substeps_of_motors() -> None:
    lane, four = chain_of(1.0, 1e3, AMPLITUDE), {"num_solver_iterations": 4, "units": "SI"}
    assert off_the_law("rapier:joint:default", lane, "rapier:joint:native", **four) < SINGLE_PRECISION_PERIOD
    assert off_the_law("rapier:joint:default", lane, "rapier:joint:native") > 1e-3
