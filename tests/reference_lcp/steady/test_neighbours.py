"""Steady states beside those of the Euler scheme: the same as from harmonic balance, in fewer periods, or anew."""

import numpy as np
import pytest

from reference_lcp import Chain, CompiledSimulation, HarmonicBase, Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.observables.stick_slip import contact_modes
from reference_lcp.observables.transmittance import transmittance
from reference_lcp.steady import neighbours
from reference_lcp.steady.amplification import PeriodInverse
from reference_lcp.steady.neighbours import (
    LONGEST_CHAIN,
    NEWTON_PERIODS,
    orbits_beside,
    orbits_beside_euler,
    orbits_from_balance,
)
from reference_lcp.steady.orbits import periodic_orbits

STEPS = 400
TOLERANCE = 1e-10
POINTS = ((0.05, 0.8), (0.1, 0.5), (0.3, 0.9), (1.0, 1.2), (10.0, 0.7))
"""Of figure 3; the contacts of the last stay stuck, and their offsets are arbitrary."""


def simulation_of(friction: float = 1.0, cells: int = 7) -> CompiledSimulation:
    """The canonical chain at all points, with so many times the friction."""
    chains = [(Chain.from_ratios(cells=cells, friction_ratio=friction * ratio), eta) for ratio, eta in POINTS]
    return CompiledSimulation(
        [Lane.periodic(chain, HarmonicBase.from_ratio(chain, eta), STEPS) for chain, eta in chains]
    )


def rubbing_harder(monkeypatch) -> CompiledSimulation:
    """Something near to the scheme: a hundredth more friction than its lanes have."""
    honest, harder = simulation_of(), simulation_of(1.01)
    monkeypatch.setattr(neighbours, "euler_simulation", lambda _: honest)
    return harder


def amplitudes(orbits) -> np.ndarray:
    return np.array([abs(transmittance(orbit)) for orbit in orbits])


def test_beside_the_scheme_the_same_motion_is_found_in_half_of_the_periods(monkeypatch) -> None:
    harder = rubbing_harder(monkeypatch)
    balanced = periodic_orbits(harder, STEPS, tolerance=TOLERANCE)
    beside = orbits_beside_euler(harder, STEPS, tolerance=TOLERANCE)
    assert all(orbit.converged for orbit in beside)
    assert amplitudes(beside) == pytest.approx(amplitudes(balanced), rel=1e-7)
    assert sum(orbit.periods for orbit in beside) < sum(orbit.periods for orbit in balanced) / 2


def test_offsets_of_cells_that_stay_stuck_are_left_to_the_period() -> None:
    """Where no distance makes a residual, I − J has no inverse: the step there is the residual itself."""
    orbits = periodic_orbits(simulation_of(), STEPS)
    inverse = PeriodInverse.of(orbits)
    stuck = [np.sum(np.all(contact_modes(orbit) == 0, axis=0)) for orbit in orbits]
    assert np.trace(inverse.unexplained, axis1=1, axis2=2) == pytest.approx(stuck)
    assert (stuck[0], stuck[-1]) == (0, 7)
    kept = inverse.unexplained[-1]
    assert kept @ inverse.newton[-1] @ kept == pytest.approx(kept, abs=1e-6)


def test_steps_that_lead_nowhere_are_given_up_for_harmonic_balance() -> None:
    """Newton's steps of the wrong sign lead away; what is then found is what harmonic balance leads to."""
    simulation = simulation_of()
    orbits = periodic_orbits(simulation, STEPS, tolerance=TOLERANCE)
    away = -30 * PeriodInverse.of(orbits).newton
    start = State.at_rest(len(orbits), 7)
    found = orbits_beside(simulation, start, [True] * len(orbits), away, STEPS, tolerance=TOLERANCE)
    assert [orbit.converged for orbit in found] == [True] * len(orbits)
    assert amplitudes(found) == pytest.approx(amplitudes(orbits), rel=1e-7)


def test_where_nothing_is_found_and_nothing_else_is_to_be_tried_the_best_of_the_search_is_given() -> None:
    simulation = simulation_of()
    orbits = periodic_orbits(simulation, STEPS, tolerance=TOLERANCE)
    away = -30 * PeriodInverse.of(orbits).newton
    start = State.at_rest(len(orbits), 7)
    known = [True] * len(orbits)
    found = orbits_beside(simulation, start, known, away, STEPS, tolerance=TOLERANCE, longest_multiple=1, anew=False)
    assert [orbit.converged for orbit in found] == [False] * len(orbits)
    assert max(orbit.periods for orbit in found) == NEWTON_PERIODS + 1


def test_from_harmonic_balance_the_same_motion_is_found_by_newtons_steps_in_two_thirds_of_the_periods(
    monkeypatch,
) -> None:
    harder = rubbing_harder(monkeypatch)
    plain = periodic_orbits(harder, STEPS, tolerance=TOLERANCE)
    newton = orbits_from_balance(harder, STEPS, tolerance=TOLERANCE)
    assert all(orbit.converged for orbit in newton)
    assert amplitudes(newton) == pytest.approx(amplitudes(plain), rel=1e-7)
    assert sum(orbit.periods for orbit in newton) < sum(orbit.periods for orbit in plain) * 2 / 3


def test_long_chains_are_searched_without_their_jacobian(monkeypatch) -> None:
    monkeypatch.setattr(neighbours, "LONGEST_CHAIN", 6)
    monkeypatch.setattr(neighbours, "PeriodInverse", None)
    assert LONGEST_CHAIN > 7
    assert all(orbit.converged for orbit in orbits_beside_euler(simulation_of(), STEPS, tolerance=TOLERANCE))
