"""The chains, the states and the tolerances that the contract is tested with."""

import dataclasses
from collections.abc import Mapping, Sequence

import numpy as np

from multibody_xval.engines.interface.tolerances import CREEP, STEPS
from multibody_xval.engines.interface.variant import Variant
from reference_lcp.chain.drives import HarmonicBase, HarmonicForce, PeriodicDrive
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.preload import Preload
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.chain.transient import QUIET, RickerPulse
from reference_lcp.defaults import BASE_AMPLITUDE
from reference_lcp.validation import FloatArray

CELLS, SEED = 7, 20

UNITS_AND_DRIVES = (
    (1.0, 1e3, 0.01, False),
    (0.3, 400.0, 0.002, True),
    (5.0, 2e3, 0.05, False),
    (2.0, 5e4, 0.004, True),
)
"""Mean outer mass [kg], mean stiffness [N/m], displacement scale [m], and whether a force drives: masses of hand-held
parts to small machines, from 2 to 25 Hz, since some presets have a time or a velocity of their own."""


def lane_of(friction_ratio: float, frequency_ratio: float, steps: int = STEPS) -> Lane:
    """Give the canonical chain of figure 3 at a point of it."""
    chain = Chain.from_ratios(friction_ratio=friction_ratio)
    return Lane.periodic(chain, HarmonicBase.from_ratio(chain, frequency_ratio, BASE_AMPLITUDE), steps)


FINER = 32
"""Steps of the reference to one of an engine that does not share its scheme, which is of first order: at 400 steps a
period its error reaches 0.2 dB on the steepest flanks of Figure 3, at 32 times as many 0.006 dB."""


def finer(lane: Lane, part: int = FINER) -> Lane:
    """Give a lane with so many steps to one."""
    return dataclasses.replace(lane, time_step=lane.time_step / part)


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


def random_lanes() -> list[Lane]:
    """Give chains of unequal cells, μ a cell, inner dashpots, in several units of mass, length and time.

    Two are driven by their base, two by a force on cell 1.
    """
    rng, lanes = np.random.default_rng(SEED), []
    for mass, stiffness, amplitude, forced in UNITS_AND_DRIVES:
        outer, springs = mass * rng.uniform(0.7, 1.5, CELLS), stiffness * rng.uniform(0.7, 1.5, CELLS)
        inner, inner_springs = outer * rng.uniform(0.5, 2.0, CELLS), springs * rng.uniform(0.5, 2.0, CELLS)
        chain = Chain(
            cells=CELLS,
            outer_mass=outer,
            inner_mass=inner,
            chain_stiffness=springs,
            inner_stiffness=inner_springs,
            chain_damping=2 * rng.uniform(0.005, 0.02, CELLS) * np.sqrt(springs * outer),
            inner_damping=2 * rng.uniform(0.0, 0.04, CELLS) * np.sqrt(inner_springs * inner),
            normal_force=rng.uniform(0.5, 2.0, CELLS) * stiffness * amplitude,
            friction_coefficient=rng.uniform(0.1, 0.8, CELLS),
        )
        base = HarmonicBase.from_ratio(chain, 0.9, amplitude)
        force = HarmonicForce(stiffness * amplitude, base.angular_frequency)
        lanes.append(Lane.periodic(chain, force if forced else base, STEPS))
    return lanes


def scaled_state(lanes: Sequence[Lane], seed: int = 0) -> State:
    """Give a random state for every lane: half its displacement scale, and as fast as the drive makes that."""
    rng = np.random.default_rng(seed)
    scales = np.array([lane.drive.displacement_scale(lane.chain) for lane in lanes])
    rates = np.array([2 * np.pi / (STEPS * lane.time_step) for lane in lanes])
    positions, velocities = 0.5 * rng.normal(size=(2, len(lanes), 2 * lanes[0].chain.cells))
    return State(positions * scales[:, None], velocities * (scales * rates)[:, None])


def drive_of(lane: Lane) -> PeriodicDrive:
    """Give the drive of a lane of `lane_of`, which is periodic."""
    assert isinstance(lane.drive, HarmonicBase)
    return lane.drive


def run_of(variant: Variant, lane: Lane, state: State, steps: int) -> Trajectory:
    """Run one lane from a state at step zero."""
    return variant.build([lane]).run(state, 0, steps)[0]


def unexplained_impulse(lane: Lane, run: Trajectory) -> FloatArray:
    """Give M Δq − ∫ (f − K u − C q + W_T λ_T) dt of every mass with the reported forces, over the largest momentum."""
    chain, load = lane.chain, np.zeros_like(run.positions)
    load[:, 0] = lane.drive.load(chain, run.time)
    force = load - run.positions @ chain.stiffness_matrix - run.velocities @ chain.damping_matrix
    impulse = np.sum(force[:-1] + (run.friction @ chain.contact_directions.T)[1:], axis=0) * lane.time_step
    change = (run.velocities[-1] - run.velocities[0]) * np.diag(chain.mass_matrix)
    missing: FloatArray = (change - impulse) / np.max(np.abs(chain.mass_matrix @ run.velocities.T))
    return missing


LEAST_BOUND = 1e-100
"""[N], in place of a bound of zero: any friction passes that by far."""


def part_above(friction: FloatArray, bound: FloatArray) -> float:
    """Give by which part of its bound friction passes it at most; negative where it stays below."""
    return float(np.max((friction - bound) / np.maximum(bound, LEAST_BOUND)))


def tolerance_of(variant: Variant, by_precision: Mapping[str, float], *, modulated: bool = False) -> float:
    """Give what the contract allows at a variant's precision, and what its residual slip compliance adds to it."""
    preset = variant.preset.modulated() if modulated else variant.preset
    return by_precision[variant.capabilities.precision] + CREEP * preset.residual_slip_compliance
