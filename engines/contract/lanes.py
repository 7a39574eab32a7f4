"""The chains, the states and the tolerances that the contract is tested with."""

import dataclasses
from collections.abc import Mapping

import numpy as np

from engines.interface.tolerances import CREEP, STEPS
from engines.interface.variant import Variant
from reference_lcp.chain.canonical import BASE_AMPLITUDE
from reference_lcp.chain.harmonic import HarmonicBase, PeriodicDrive
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.preload import Preload
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.chain.transient import QUIET, RickerPulse


def label(variant: Variant) -> str:
    """Name a variant in the names of tests."""
    return f"{variant.engine}-{variant.formulation}-{variant.preset_name}"


def lane_of(friction_ratio: float, frequency_ratio: float, steps: int = STEPS) -> Lane:
    """Give the canonical chain of figure 3 at a point of it."""
    chain = Chain.from_ratios(friction_ratio=friction_ratio)
    return Lane.periodic(chain, HarmonicBase.from_ratio(chain, frequency_ratio, BASE_AMPLITUDE), steps)


def modulated_lane(modulation: float, multiple: int = 1, steps: int = STEPS) -> Lane:
    """Give the canonical chain in its pass band, its preload modulated at a multiple of the drive's frequency."""
    lane = lane_of(0.3, 0.6, steps)
    return dataclasses.replace(lane, preload=Preload.at_multiple(drive_of(lane), modulation, multiple))


def pulse_lane_of(friction_ratio: float) -> Lane:
    """Give the canonical chain under one pulse of the base, with its peak at ω_r."""
    chain = Chain.from_ratios(friction_ratio=friction_ratio)
    omega = chain.resonator_frequency
    return Lane(chain, RickerPulse(BASE_AMPLITUDE, omega, QUIET / omega), 2 * np.pi / omega / STEPS)


def random_state(lanes: int, seed: int = 0) -> State:
    """Give positions of U0 and velocities as fast as a forced motion has them."""
    rng = np.random.default_rng(seed)
    return State(rng.normal(0, BASE_AMPLITUDE, (lanes, 14)), rng.normal(0, 20 * BASE_AMPLITUDE, (lanes, 14)))


def drive_of(lane: Lane) -> PeriodicDrive:
    """Give the drive of a lane of `lane_of`, which is periodic."""
    assert isinstance(lane.drive, HarmonicBase)
    return lane.drive


def run_of(variant: Variant, lane: Lane, state: State, steps: int) -> Trajectory:
    """Run one lane from a state at step zero."""
    return variant.build([lane]).run(state, 0, steps)[0]


def tolerance_of(variant: Variant, by_precision: Mapping[str, float], *, modulated: bool = False) -> float:
    """Give what the contract allows at a variant's precision, and what its residual slip compliance adds to it."""
    preset = variant.preset.modulated() if modulated else variant.preset
    return by_precision[variant.capabilities.precision] + CREEP * preset.residual_slip_compliance
