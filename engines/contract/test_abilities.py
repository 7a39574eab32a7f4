"""What a preset states that it can: hold more at rest; the others refuse it."""

import dataclasses
import re

import numpy as np
import pytest

from multibody_xval.engines.contract.lanes import lane_of, run_of
from multibody_xval.engines.interface.variant import Variant, variants_of
from reference_lcp.chain.drives import HarmonicForce
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.errors import ParameterError

STATIC_RATIO = 1.5
"""μ_s / μ_k."""

BLOCK, CARRIER, BOUND = 1.0, 20.0, 5.0
"""Masses [kg], and μ_k λ_N [N]."""

TIME_STEP, STEPS_PULLED, STEPS_OF_JUMP = 2e-3, 200, 40
"""Step [s], steps in which the load grows to its largest, and those of a jump, of half a swing of block and spring."""

STIFFNESS = BLOCK * (np.pi / (STEPS_OF_JUMP * TIME_STEP)) ** 2
"""Of the spring that the block jumps against [N/m]."""

JUMP = 2 * (STATIC_RATIO - 1) * BOUND / STIFFNESS
"""2 (μ_s − μ_k) λ_N / k [m], the jump under a load that stays."""

HELD, BREAKS = 0.85, 1.2
"""Loads over μ_s λ_N: above μ_k λ_N by a quarter, and above what holds."""

CREEP = 0.1
"""Of a jump: what a contact may creep that holds."""

HOLDS_LEAST, SLIDES = 0.95, 0.01
"""Of μ_s λ_N: what is held at the end of some step, if not of the last. And of μ_k λ_N: what decays of static friction
with the velocity of a slip."""


def pulled(variant: Variant, load: float) -> Trajectory:
    """Pull the carrier of a block, free but for a weak spring; the load on the block grows as a sine to its crest."""
    numbers = {
        "outer_mass": CARRIER,
        "inner_mass": BLOCK,
        "chain_stiffness": 1e-6,
        "inner_stiffness": STIFFNESS,
        "normal_force": 2 * BOUND,
        "friction_coefficient": 0.5,
    }
    chain = Chain(cells=1, **{name: np.asarray(value) for name, value in numbers.items()})
    amplitude = (1 + CARRIER / BLOCK) * load * STATIC_RATIO * BOUND
    force = HarmonicForce(amplitude, np.pi / 2 / (STEPS_PULLED * TIME_STEP), JUMP)
    lane = Lane(chain, force, TIME_STEP, static_ratio=STATIC_RATIO)
    return run_of(variant, lane, State.at_rest(1, 1), STEPS_PULLED)


def slips(run: Trajectory) -> np.ndarray:
    """Slip in all steps, over the jump."""
    return np.abs(run.positions[:, 1] - run.positions[:, 0]) / JUMP


def test_contact_at_rest_holds_more_than_it_slides_with(holding: Variant) -> None:
    """A load between both bounds does not move the block."""
    run = pulled(holding, HELD)
    assert slips(run)[-1] <= CREEP, f"slips under {HELD} of what it should hold, by a part of a jump"
    off = np.abs(np.abs(run.friction[-1, 0]) / (HELD * STATIC_RATIO * BOUND) - 1)
    assert off <= CREEP, "the friction is not the load, by a part of it"


def test_contact_that_lets_go_jumps_under_kinetic_friction(holding: Variant) -> None:
    """The friction that is reported passes μ_k λ_N up to μ_s λ_N before, and is μ_k λ_N while the block is fast."""
    run = pulled(holding, BREAKS)
    assert slips(run)[-1] >= 1, "jumps less than 2 (μ_s − μ_k) λ_N / k, by a part of it"
    friction = np.abs(run.friction[:, 0]) / BOUND
    assert np.max(friction) >= HOLDS_LEAST * STATIC_RATIO, "lets go too early, over μ_k λ_N"
    assert np.max(friction) <= STATIC_RATIO * (1 + SLIDES), "holds too much, over μ_k λ_N"
    speed = np.abs(run.relative_velocity[:, 0])
    sliding = friction[speed > np.max(speed) / 2]
    assert np.max(np.abs(sliding - 1)) <= SLIDES, "slides with another friction than μ_k λ_N, by a part of it"


def test_static_friction_that_a_preset_does_not_state_is_refused(installed: str) -> None:
    """With the number, and the formulation that lacks it."""
    lane = dataclasses.replace(lane_of(0.3, 0.6), static_ratio=STATIC_RATIO)
    for variant in variants_of(installed):
        if not variant.preset.static_friction:
            refusal = rf"static_ratio = 1\.5: .*{re.escape(variant.formulation)}.* cannot"
            with pytest.raises(ParameterError, match=refusal):
                variant.build([lane])
