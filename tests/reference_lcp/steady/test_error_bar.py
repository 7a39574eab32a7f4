"""Error bars against the exact solver, and the order of the scheme that they rest on."""

import math

import numpy as np
import pytest

from reference_lcp import (
    Chain,
    HarmonicBase,
    exact_steady_state,
    steady_state,
)
from reference_lcp.chain.simulation import PeriodicOrbit, steps_per_period_for
from reference_lcp.exact.exact_orbit import ExactPeriod, exact_orbit
from reference_lcp.observables.stick_slip import match_transitions, transitions
from reference_lcp.observables.transmittance import complex_transmittance, decibel, transmittance
from reference_lcp.steady.error_bar import REFINEMENTS, ErrorBar, measured_error_bar
from reference_lcp.steady.richardson import SAFETY
from tests.reference_lcp.cases import canonical_lane, driven, error_bar, euler_orbit, fitted_order

COVERED = 0.97
"""Part of the exact values that bars must cover."""


@pytest.mark.parametrize(("friction", "ratio"), [(0.1, 0.6), (0.3, 0.9), (0.6, 1.3), (1.0, 0.9)])
def test_scheme_is_of_first_order_in_transmittance_and_in_transition_times(friction, ratio) -> None:
    """Slopes of straight lines through seven steps, both axes logarithmic."""
    chain, drive = driven(ratio, friction_ratio=friction)
    exact = exact_orbit(chain, drive)[1]
    orbits = [euler_orbit(chain, drive, 400 * 2**k) for k in range(7)]
    levels = [abs(decibel(transmittance(orbit)) - decibel(exact.transmittance)) for orbit in orbits]
    matches = [match_transitions(transitions(orbit), exact.transitions, drive.period) for orbit in orbits]
    times = [np.mean(np.abs(list(match.errors.values()))) for match in matches]
    assert [fitted_order(levels), fitted_order(times)] == pytest.approx([1.0, 1.0], abs=0.15)


def test_extrapolated_value_is_closer_than_the_computed_one() -> None:
    chain, drive = driven(1.3, friction_ratio=0.6)
    steady, exact = steady_state(chain, drive), exact_steady_state(chain, drive)
    plain = abs(steady.transmittance_db - exact.transmittance_db)
    assert abs(steady.error_bar.extrapolated_db - exact.transmittance_db) < plain / 5
    assert steady.error_bar.order == pytest.approx(1.0, abs=0.3)
    assert plain <= steady.error_bar.transmittance_db <= 4 * SAFETY * plain


def test_error_bar_that_was_not_requested_is_absent_and_the_exact_solver_has_none() -> None:
    case = driven(0.9, friction_ratio=0.3)
    assert steady_state(*case, with_error_bar=False).error_bar is None
    assert steady_state(*case, solver="exact").error_bar is None


def test_a_residual_that_is_loose_widens_the_bar() -> None:
    chain, drive = driven(0.9, friction_ratio=0.3)
    sharp, exact_db = steady_state(chain, drive, tolerance=1e-10), exact_steady_state(chain, drive).transmittance_db
    loose = steady_state(chain, drive, tolerance=1e-2)
    assert abs(loose.transmittance_db - exact_db) > sharp.error_bar.transmittance_db
    assert abs(loose.transmittance_db - exact_db) < loose.error_bar.transmittance_db


def test_stuck_fractions_and_times_of_transitions_have_error_bars() -> None:
    """Of the canonical chain at (0.3, 0.9): fourteen transitions within a step and a half of the exact ones."""
    chain, drive = driven(0.9, friction_ratio=0.3)
    steady, exact = steady_state(chain, drive), exact_steady_state(chain, drive)
    assert np.all(np.abs(steady.stuck_fraction - exact.stuck_fraction) <= steady.error_bar.stuck_fraction)
    pairs = list(zip(steady.transitions, exact.transitions, strict=True))
    assert [(a.cell, a.kind) for a, _ in pairs] == [(b.cell, b.kind) for _, b in pairs]
    bars, step = steady.error_bar.transition_time, steady.orbit.lane.time_step
    assert np.all([abs(a.time - b.time) for a, b in pairs] <= bars)
    assert np.all((bars >= step) & (bars <= 8 * step))


def bars_are_equal(one: ErrorBar, other: ErrorBar) -> None:
    """Up to what the residual of the finer steps leaves open, 1e-8 of the base's amplitude times some ten."""
    assert one.transmittance_db == pytest.approx(other.transmittance_db, abs=1e-5)
    assert one.extrapolated_db == pytest.approx(other.extrapolated_db, abs=1e-5, nan_ok=True)
    assert one.floor_db == pytest.approx(other.floor_db, nan_ok=True)
    assert one.stuck_fraction == pytest.approx(other.stuck_fraction, abs=1e-12)
    assert one.transition_time == pytest.approx(other.transition_time, abs=1e-12, nan_ok=True)
    assert one.missing_transitions == other.missing_transitions
    assert one.steps_per_period == other.steps_per_period


@pytest.mark.parametrize(("friction", "ratio"), [(0.1, 0.5), (3.0, 1.1)])
def test_finer_steps_from_coarser_ones_end_where_those_from_harmonic_balance_do(friction, ratio) -> None:
    lane = canonical_lane(friction, ratio)
    orbits = [euler_orbit(lane.chain, lane.drive, 400 * factor) for factor in REFINEMENTS]
    bars_are_equal(measured_error_bar(orbits[0]), error_bar(orbits))


def test_finer_steps_without_a_steady_state_leave_every_bar_unknown() -> None:
    bar = measured_error_bar(euler_orbit(*driven(0.9, friction_ratio=0.3), 400), max_periods=2)
    assert math.isnan(bar.transmittance_db)
    assert np.all(np.isnan(bar.stuck_fraction))
    assert np.all(np.isnan(bar.transition_time))


def random_setting(seed: int, number: int) -> tuple[Chain, HarmonicBase]:
    """Give one random chain and its drive: 1…10 cells, ratios over a decade each, the range of figure 3."""
    rng = np.random.default_rng([seed, number])

    def between(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    chain = Chain.from_ratios(
        cells=int(rng.integers(1, 11)),
        mass_ratio=between(0.3, 3),
        stiffness_ratio=between(0.3, 3),
        damping_ratio=between(0.003, 0.03),
        friction_ratio=between(0.01, 5),
    )
    return chain, HarmonicBase.from_ratio(chain, float(rng.uniform(0.1, 3)))


def bars_beside_the_exact_motion(seed: int, number: int) -> tuple[list[PeriodicOrbit], list[ErrorBar], ExactPeriod]:
    """Orbits of a random chain with three steps, the bar of each, and the exact motion."""
    chain, drive = random_setting(seed, number)
    fewest = steps_per_period_for(chain, drive)
    orbits = [euler_orbit(chain, drive, fewest * factor) for factor in REFINEMENTS]
    return orbits, [error_bar(orbits, place) for place in range(len(orbits))], exact_orbit(chain, drive)[1]


def covers(orbit: PeriodicOrbit, bar: ErrorBar, exact: ExactPeriod) -> bool:
    """Whether a bar covers the exact transmittance, or its floor holds it."""
    level = decibel(exact.transmittance)
    if not bar.resolved:
        return level <= bar.floor_db
    return abs(decibel(transmittance(orbit)) - level) <= bar.transmittance_db


@pytest.mark.parametrize(("chains", "of_phases"), [(8, 0.9), pytest.param(100, COVERED, marks=pytest.mark.slow)])
def test_bars_cover_the_exact_values_of_random_chains(chains: int, of_phases: float) -> None:
    covered, phases, times = [], [], []
    for number in range(chains):
        orbits, bars, exact = bars_beside_the_exact_motion(2, number)
        for orbit, bar in zip(orbits, bars, strict=True):
            covered.append(covers(orbit, bar, exact))
            phase = np.angle(complex_transmittance(orbit) / exact.complex_transmittance)
            phases += [abs(float(phase)) <= bar.phase] * bar.resolved
            match = match_transitions(exact.transitions, transitions(orbit), exact.period)
            known = dict(zip(transitions(orbit), bar.transition_time, strict=True))
            times += [not abs(error) * exact.period > known[change] for change, error in match.errors.items()]
    assert np.mean(covered) >= COVERED
    assert np.mean(phases) >= of_phases
    assert np.mean(times) >= COVERED


def flagged(bar: ErrorBar) -> int:
    """Transitions that the bar calls inconclusive, and those that other steps alone show."""
    return int(np.sum(np.isnan(bar.transition_time))) + len(bar.missing_transitions)


def test_transmittance_below_the_residual_has_a_floor_that_holds_it_in_place_of_a_bar(monkeypatch) -> None:
    """A chain of nine cells at −187 dB by the scheme, −192 dB in truth; its three steps differ by 1 dB only."""
    (orbit, *_), (bar, *_), exact = bars_beside_the_exact_motion(0, 33)
    assert not bar.resolved
    assert math.isinf(bar.transmittance_db)
    assert decibel(exact.transmittance) < bar.floor_db < -120
    monkeypatch.setattr("reference_lcp.steady.error_bar.unresolved_amplitude", lambda *_: 0.0)
    (orbit, *_), (bar, *_), exact = bars_beside_the_exact_motion(0, 33)
    assert not covers(orbit, bar, exact)


@pytest.mark.parametrize("chain", [(0, 189), (611, 221)])
def test_sticks_that_finer_steps_show_only_or_none_are_flagged(chain, monkeypatch) -> None:
    """Three cells with two sticks that are shorter than the coarsest step; nine, of which one sticks for 0.0014."""
    assert [flagged(bar) for bar in bars_beside_the_exact_motion(*chain)[1]] == [4, 4, 4]
    monkeypatch.setattr("reference_lcp.steady.error_bar.MARGINAL_STEPS", 0)
    assert chain == (0, 189) or flagged(bars_beside_the_exact_motion(*chain)[1][0]) < 4
