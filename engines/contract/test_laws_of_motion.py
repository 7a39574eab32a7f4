"""What mechanics requires: momentum, energy, linear limits, motions that never drift apart, forces of contacts."""

import dataclasses
from collections.abc import Sequence

import numpy as np
import pytest

from multibody_xval.engines.contract.lanes import (
    drive_of,
    lane_of,
    part_above,
    random_state,
    run_of,
    tolerance_of,
    unexplained_impulse,
)
from multibody_xval.engines.interface.presets import FrictionLaw
from multibody_xval.engines.interface.tolerances import (
    BOUND_MARGIN,
    DISTANCE_GROWTH,
    LINEAR_TOLERANCE_DB,
    MOMENTUM_TOLERANCE,
    ROUND_OFF,
    SLIDING,
    STEPS,
    TRAJECTORY_TOLERANCE,
)
from multibody_xval.engines.interface.variant import Variant
from reference_lcp.chain.drives import HarmonicBase, StillBase
from reference_lcp.chain.linear_response import frictionless_transmittance, stuck_transmittance
from reference_lcp.chain.mass_in_mass import Chain, mechanical_energy
from reference_lcp.chain.simulation import Lane
from reference_lcp.defaults import BASE_AMPLITUDE
from reference_lcp.observables.transmittance import decibel, transmittance
from reference_lcp.steady.neighbours import beside_euler
from reference_lcp.validation import FloatArray

FIRST_ORDER = 2.0
"""Steps of first order may keep energy in other amounts than the exact motion: twice the impulse is allowed."""


def largest_growth(rows: FloatArray) -> float:
    """Largest growth over the smallest value so far, as a part of it."""
    return float(np.max(rows[1:] / np.minimum.accumulate(rows)[:-1] - 1))


def test_momentum_changes_by_the_impulse_of_the_reported_forces(tuned: Variant) -> None:
    """M Δq = ∫ (f − K u − C q + W_T λ_T) dt over a period, with the reported forces."""
    lane = lane_of(0.3, 0.9, 4 * STEPS)
    run = run_of(tuned, lane, random_state(1), 4 * STEPS)
    missing = np.max(np.abs(unexplained_impulse(lane, run)))
    assert missing <= MOMENTUM_TOLERANCE, "the forces do not explain the motion: momentum is missing, as a part"


def test_energy_of_a_free_motion_is_never_created(tuned: Variant) -> None:
    """Without a drive, springs give back at most what they took, and contacts and dashpots keep theirs."""
    driven = lane_of(0.1, 0.6)
    lane = Lane(driven.chain, StillBase(driven.drive.displacement_scale(driven.chain)), driven.time_step)
    run = run_of(tuned, lane, random_state(1), 4 * STEPS)
    rows = mechanical_energy(lane.chain, run.positions, run.velocities)
    assert largest_growth(rows) <= 2 * DISTANCE_GROWTH, "energy is created, as a part"
    assert rows[-1] <= 0.5 * rows[0], "friction and dashpots take no energy [J]"


def test_frictionless_limit_is_the_linear_response(tuned: Variant) -> None:
    """(K + iωC − ω²M) u = f."""
    lanes = [lane_of(0.0, ratio) for ratio in (0.5, 0.9, 1.6)]
    _steady_levels_are(tuned, lanes, [frictionless_transmittance(lane.chain, drive_of(lane)) for lane in lanes])


def _steady_levels_are(tuned: Variant, lanes: Sequence[Lane], exact: Sequence[float]) -> None:
    """Search beside the reference: the residual of the engine's own period ends it."""
    simulation = tuned.build(lanes)
    orbits = beside_euler(simulation, STEPS, tolerance=tuned.capabilities.residual)
    simulation.close()
    assert all(orbit.converged for orbit in orbits), "no steady state"
    levels = [float(decibel(transmittance(orbit))) for orbit in orbits]
    off = np.max(np.abs(np.array(levels) - [float(decibel(value)) for value in exact]))
    assert off <= LINEAR_TOLERANCE_DB, "the linear transmittance is off [dB]"


@pytest.mark.parametrize("friction", [1e-3, 1e-6])
def test_faint_friction_moves_the_chain_by_no_more_than_its_impulse(tested: Variant, friction: float) -> None:
    """The distance √(2 E) from the chain without friction grows by at most |M^(-1/2) W_T μ λ_N| a second.

    A preset that does more, a bristle at every reversal for example, has to say how it deviates.
    """
    lane, start = lane_of(friction, 0.6), random_state(1)
    rubbing, sliding = run_of(tested, lane, start, STEPS), run_of(tested, lane_of(0.0, 0.6), start, STEPS)
    assert np.all(np.isfinite(rubbing.positions)), "its positions are not finite"
    chain = lane.chain
    bounds = chain.friction_coefficient * rubbing.normal_force
    impulse = np.sum(np.sqrt(bounds**2 @ (1 / chain.outer_mass + 1 / chain.inner_mass))) * lane.time_step
    apart = mechanical_energy(chain, rubbing.positions - sliding.positions, rubbing.velocities - sliding.velocities)
    motion = np.sqrt(2 * np.max(mechanical_energy(chain, sliding.positions, sliding.velocities)))
    if np.sqrt(2 * np.max(apart)) > FIRST_ORDER * impulse + tolerance_of(tested, TRAJECTORY_TOLERANCE) * motion:
        assert tested.preset.known_deviation, "faint friction does more than its impulse, and no deviation is stated"


def test_stuck_limit_is_the_chain_of_locked_masses(tuned: Variant) -> None:
    """Under a friction that never slips, every cell is one mass."""
    lanes = [lane_of(20.0, ratio) for ratio in (0.5, 0.9, 1.2)]
    _steady_levels_are(tuned, lanes, [stuck_transmittance(lane.chain, drive_of(lane)) for lane in lanes])


def test_two_motions_under_one_drive_never_drift_apart(tuned: Variant) -> None:
    """Coulomb friction under a given normal force is monotone: the energy norm of their difference never grows."""
    lane = lane_of(0.3, 0.6)
    first, second = tuned.build([lane, lane]).run(random_state(2), 0, 4 * STEPS)
    apart, faster = first.positions - second.positions, first.velocities - second.velocities
    distance = np.sqrt(mechanical_energy(lane.chain, apart, faster))
    assert largest_growth(distance) <= DISTANCE_GROWTH, "two motions drift apart, as a part"
    assert distance[-1] <= distance[0], "two motions do not come closer"


def test_normal_force_is_the_one_that_is_given(tuned: Variant) -> None:
    """A measured one as well: nothing may press harder while a contact slides."""
    lane = lane_of(0.3, 0.6)
    run = run_of(tuned, lane, random_state(1), 50)
    off = np.max(np.abs(run.normal_force / lane.chain.normal_force - 1))
    assert off <= tolerance_of(tuned, ROUND_OFF), "the normal force is not the one that is given, as a part"


def test_cells_without_friction_feel_none(tested: Variant) -> None:
    """Of both kinds: no normal force, and no coefficient of friction."""
    chain = Chain.from_ratios(friction_ratio=[0.3, 0.0, 0.3, 0.3, 0.1, 0.3, 1.0])
    coefficient = np.where(np.arange(7) == 3, 0.0, chain.friction_coefficient)
    chain = dataclasses.replace(chain, friction_coefficient=coefficient)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.6), STEPS)
    run = run_of(tested, lane, random_state(1), 50)
    without = chain.friction_bound == 0
    assert np.all(run.friction[:, without] == 0), "a cell without friction reports some"
    assert np.all(np.any(run.friction[:, ~without] != 0, axis=0)), "a cell with friction reports none"


def test_friction_stays_within_its_bound(tested: Variant) -> None:
    """|λ_T| <= μ λ_N, in stick and in slip; of a preset that says why it may pass that, in the mean over a period."""
    lane = lane_of(0.3, 0.6)
    run = run_of(tested, lane, random_state(1), STEPS)
    friction, bound = np.abs(run.friction), lane.chain.friction_coefficient * run.normal_force
    if tested.preset.passes_bound:
        friction, bound = np.mean(friction, axis=0), np.mean(bound, axis=0)
    passed = part_above(friction, bound)
    assert passed <= BOUND_MARGIN[tested.capabilities.precision], "friction passes its bound μ λ_N, by this part of it"


def test_friction_acts_on_the_inner_mass_against_its_slip(tested: Variant) -> None:
    """Sign convention: λ_T as it acts on the inner mass, so that its power with ġ_T takes energy out."""
    lane = lane_of(0.3, 0.6)
    run = run_of(tested, lane, random_state(1), STEPS)
    power = run.friction * run.relative_velocity
    sliding = np.abs(run.relative_velocity) > SLIDING * BASE_AMPLITUDE * drive_of(lane).angular_frequency
    if tested.capabilities.friction_law is FrictionLaw.BRISTLE or tested.preset_name != "tuned":
        # a bristle that has been bent gives its energy back after a reversal, and a soft constraint acts late:
        # only their sum is a loss
        assert np.all(np.sum(power, axis=0) < 0), "friction drives the slip"
    else:
        assert np.all(power[sliding] < 0), "friction drives the slip"
