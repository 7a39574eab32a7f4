"""A normal force that changes in time, for presets that represent it; refused by those that do not."""

import re

import numpy as np
import pytest

from multibody_xval.engines.contract.lanes import FINER, finer, modulated_lane, run_of, tolerance_of
from multibody_xval.engines.interface.presets import NormalForce
from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.tolerances import (
    BOUND_MARGIN,
    CONVERGED_TOLERANCE_DB,
    MEETING_STEPS,
    MOMENTUM_TOLERANCE,
    ROUND_OFF,
    SHORT_FLIGHT,
    STEPS,
    TRAJECTORY_TOLERANCE,
)
from multibody_xval.engines.interface.variant import Variant, variants_of
from reference_lcp.chain.preload import Flight
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.defaults import BASE_AMPLITUDE
from reference_lcp.errors import ParameterError
from reference_lcp.observables.stick_slip import OPEN
from reference_lcp.observables.transmittance import decibel, transmittance
from reference_lcp.steady.orbits import periodic_orbits


def run_from_rest(variant: Variant, modulation: float, periods: int, multiple: int = 1) -> Trajectory:
    """Run a modulated lane."""
    return run_of(variant, modulated_lane(modulation, multiple), State.at_rest(1, 7), periods * STEPS)


def test_modulated_normal_force_is_followed(following_tuned: Variant) -> None:
    """Contacts that stay closed: the normal force is the normal load, and friction moves the chain accordingly."""
    following = following_tuned
    lane = modulated_lane(0.5, 2)
    run, expected = (run_from_rest(variant, 0.5, 4, 2) for variant in (following, Variant("reference")))
    given, tolerance = lane.preloads(0, 4 * STEPS), tolerance_of(following, ROUND_OFF, modulated=True)
    assert np.allclose(run.normal_force, given, rtol=tolerance, atol=0), "another normal force"
    if following.preset.shares_scheme:
        motion = np.max(np.abs(run.positions - expected.positions)) / BASE_AMPLITUDE
        tolerance = tolerance_of(following, TRAJECTORY_TOLERANCE, modulated=True)
        assert motion <= tolerance, "the motion differs from the reference's [U0]"
    else:
        orbit = periodic_orbits(following.build([lane]), STEPS, tolerance=following.capabilities.residual)[0]
        baseline = periodic_orbits(engine("reference").build([finer(lane)]), FINER * STEPS)[0]
        difference = float(decibel(transmittance(orbit)) - decibel(transmittance(baseline)))
        assert abs(difference) <= CONVERGED_TOLERANCE_DB, "transmittance off [dB]"


def test_friction_stays_within_a_bound_that_changes(following: Variant) -> None:
    """|λ_T| <= μ λ_N(t) in every step; where contacts are open there is none."""
    lifts = following.preset.represents(NormalForce.LIFTING)
    lane = modulated_lane(1.5 if lifts else 1.0)
    run = run_from_rest(following, 1.5 if lifts else 1.0, 2)
    bound = lane.chain.friction_coefficient * run.normal_force
    margin = BOUND_MARGIN[following.capabilities.precision]
    # The normal load at a step's start may be rounded to nothing of the mean.
    mean = lane.chain.friction_bound
    passed = np.max((np.abs(run.friction) - bound) / (bound + mean))
    assert passed <= margin, "friction passes its bound μ λ_N(t), over that and its mean"
    if not lifts:
        given = lane.chain.friction_coefficient * lane.preloads(0, 2 * STEPS)
        wider = tolerance_of(following, BOUND_MARGIN, modulated=True)
        passed = np.max((np.abs(run.friction) - (1 + wider) * given) / mean)
        assert passed <= margin, "friction passes its bound by the normal force that is given, over its mean"


def test_contact_that_is_pulled_open_flies_lands_and_carries_the_impact(lifting: Variant) -> None:
    """Time in the air, largest gap and impulse of a cycle, against N(t) integrated twice."""
    lane = modulated_lane(1.5)
    run, flight = run_from_rest(lifting, 1.5, 3), Flight.of(lane.preload) if lane.preload else None
    assert flight is not None
    assert run.normal_gap is not None, "no gap is reported"
    cycle = slice(STEPS, 2 * STEPS)
    mean = lane.chain.normal_force
    steps_in_air = np.sum(run.normal_force[cycle] <= OPEN * mean, axis=0)
    late = np.max(np.abs(steps_in_air - flight.open_fraction * STEPS))
    assert late <= MEETING_STEPS, "time in the air off by steps"
    scale = mean / lane.chain.inner_mass * (lane.time_step * STEPS / (2 * np.pi)) ** 2
    short = np.max(np.abs(np.max(run.normal_gap[cycle], axis=0) / scale - flight.highest))
    assert short <= SHORT_FLIGHT, "the flight has another height, over N0 / (m Ω²)"
    impulse = np.max(np.abs(np.sum(run.normal_force[cycle], axis=0) / (mean * STEPS) - 1))
    assert impulse <= MOMENTUM_TOLERANCE, "the impact is not that of the flight, as a part"


def test_run_that_is_split_in_a_flight_equals_the_whole_one(lifting: Variant) -> None:
    """A state holds the gaps of open contacts, and how fast they change."""
    simulation, split = lifting.build([modulated_lane(1.5)]), 3 * STEPS // 4
    whole = simulation.run(State.at_rest(1, 7), 0, 2 * STEPS)[0]
    half = simulation.advance(State.at_rest(1, 7), 0, split)
    second = simulation.run(half, split, 2 * STEPS - split)[0]
    assert whole.normal_gap is not None
    assert np.all(whole.normal_gap[split - 1] > 0), "there is no flight to split"
    allowed = lifting.preset.split_tolerance * BASE_AMPLITUDE
    assert np.max(np.abs(whole.positions[split:] - second.positions)) <= allowed, "the second half starts elsewhere [m]"


def test_normal_force_that_cannot_be_represented_is_refused(installed: str) -> None:
    """By those whose normal force is constant any, by those whose contacts stay closed one that opens them."""
    for variant in variants_of(installed):
        for modulation, needed in ((0.5, NormalForce.MODULATED), (1.5, NormalForce.LIFTING)):
            if not variant.preset.represents(needed):
                with pytest.raises(
                    ParameterError, match=rf"{re.escape(f'modulation = {modulation:g}:')} .* cannot represent"
                ):
                    variant.build([modulated_lane(modulation)])
