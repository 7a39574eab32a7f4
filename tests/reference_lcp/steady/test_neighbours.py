"""Steady states beside those of the Euler scheme: the same as from harmonic balance, in fewer periods, or anew."""

import dataclasses

import numpy as np
import pytest

from reference_lcp import HarmonicForce
from reference_lcp.chain.preload import Preload
from reference_lcp.chain.simulation import PeriodicOrbit
from reference_lcp.chain.trajectory import State
from reference_lcp.observables.transmittance import transmittance
from reference_lcp.schemes.euler import CompiledSimulation
from reference_lcp.steady import neighbours
from reference_lcp.steady.anderson import StateScales
from reference_lcp.steady.neighbours import (
    PeriodInverse,
    beside_euler,
    refined_orbits,
    residual_amplification,
)
from reference_lcp.steady.orbits import periodic_orbits
from tests.reference_lcp.cases import canonical_lane, driven, euler_orbit, one_cell

STEPS = 400
TOLERANCE = 1e-10
POINTS = ((0.05, 0.8), (0.1, 0.5), (0.3, 0.9), (1.0, 1.2), (10.0, 0.7))
"""Of figure 3; the contacts of the last stay stuck, and their offsets are arbitrary."""


def simulation_of(friction: float = 1.0) -> CompiledSimulation:
    """The canonical chain at all points, with so many times the friction."""
    return CompiledSimulation([canonical_lane(friction * ratio, eta) for ratio, eta in POINTS])


def amplitudes(orbits) -> np.ndarray:
    return np.array([abs(transmittance(orbit)) for orbit in orbits])


def test_beside_the_scheme_the_same_motion_is_found_in_half_of_the_periods(monkeypatch) -> None:
    """With a hundredth more friction than the scheme has whose Jacobian is taken."""
    honest, harder = simulation_of(), simulation_of(1.01)
    monkeypatch.setattr(neighbours, "euler_simulation", lambda _: honest)
    balanced = periodic_orbits(harder, STEPS, tolerance=TOLERANCE)
    beside = beside_euler(harder, STEPS, tolerance=TOLERANCE)
    assert all(orbit.converged for orbit in beside)
    assert amplitudes(beside) == pytest.approx(amplitudes(balanced), rel=1e-7)
    assert sum(orbit.periods for orbit in beside) < sum(orbit.periods for orbit in balanced) / 2


def test_cells_that_slip_before_they_stay_stuck_are_followed_to_where_they_stick() -> None:
    """No distance makes the change of their offsets: the step there is the period itself."""
    simulation = CompiledSimulation([canonical_lane(0.6, 0.5), canonical_lane(5.0, 1.0)])
    start = State(0.1 * np.random.default_rng(0).normal(size=(2, 14)), np.zeros((2, 14)))
    assert all(orbit.converged for orbit in beside_euler(simulation, STEPS, tolerance=TOLERANCE, start=start))


@pytest.mark.parametrize("friction", [0.3, 1.0, 2.0])
def test_a_newton_step_does_not_move_cells_that_stick_just_at_their_limit(friction: float) -> None:
    """An offset there gives way by 1e-4 to 4e-3 of itself in a period: a step would take it 2,000 times as far."""
    lanes = [canonical_lane(friction, float(ratio)) for ratio in np.linspace(0.6, 1.6, 51)]
    orbits = periodic_orbits(CompiledSimulation(lanes), STEPS)
    assert np.max(np.linalg.norm(PeriodInverse.of(orbits).newton, 2, axis=(1, 2))) < 100


def test_steps_that_lead_nowhere_are_given_up_for_harmonic_balance() -> None:
    """Newton's steps of the wrong sign lead away; what is then found is what harmonic balance leads to."""
    orbit = periodic_orbits(simulation_of().subset([2]), STEPS, tolerance=TOLERANCE)[0]
    away = dataclasses.replace(PeriodInverse.of([orbit]), distance=-30 * PeriodInverse.of([orbit]).distance)
    (found,) = refined_orbits(orbit, [2], away, tolerance=TOLERANCE, max_periods=400)
    finer = euler_orbit(orbit.lane.chain, orbit.lane.drive, 2 * STEPS, tolerance=TOLERANCE)
    assert found.converged
    assert amplitudes([found]) == pytest.approx(amplitudes([finer]), rel=1e-7)


def ratios(orbit: PeriodicOrbit, periods: int, start: State) -> list[float]:
    """Distance from the steady state over the residual, period after period."""
    simulation, steps = CompiledSimulation([orbit.lane]), orbit.trajectory.steps
    scales, state = StateScales([orbit.lane], steps), start
    steady, measured = scales.vectors(orbit.trajectory.end, [0]), []
    for _ in range(periods):
        before, state = state, simulation.advance(state, 0, steps)
        distance, residual = (
            np.max(np.abs(scales.vectors(before, [0]) - other)) for other in (steady, scales.vectors(state, [0]))
        )
        measured.append(float(distance / residual))
    return measured


def test_what_is_left_of_a_free_vibration_is_as_far_off_as_its_slowest_mode_tells() -> None:
    """The base moves at the frequency of one mode: 1 / |1 − exp(λT)| of it, in the limit of small steps."""
    orbit = euler_orbit(*driven((np.sqrt(5) - 1) / 2, cells=1), 1600, tolerance=1e-12)
    factor, measured = residual_amplification(orbit), ratios(orbit, 100, State.at_rest(1, 1))
    assert 20 < measured[-1] <= factor * 1.01
    assert factor <= 2 * measured[-1]


@pytest.mark.parametrize("place", [(0.3, 0.67), (0.1, 0.5), (1.0, 1.05)])
def test_no_motion_near_a_steady_state_with_friction_is_farther_off_than_that(place) -> None:
    """Motions that differ by a hundred thousandth: contacts stick and slip as in the steady state but for moments."""
    friction, eta = place
    orbit, rng = euler_orbit(*driven(eta, friction_ratio=friction), STEPS, tolerance=1e-12), np.random.default_rng(3)
    factor, end = residual_amplification(orbit), orbit.trajectory.end
    scale = orbit.lane.drive.displacement_scale(orbit.lane.chain)
    rate = scale * 2 * np.pi / (orbit.trajectory.steps * orbit.lane.time_step)
    # velocities alone: an offset of a cell that stays stuck lasts, and is no error
    near = State(end.positions, end.velocities + 1e-5 * rate * rng.normal(size=end.velocities.shape))
    worst = max(ratios(orbit, 40, near)[5:])
    assert 1 < worst <= 1.5 * factor


def opening() -> PeriodicOrbit:
    """Gaps do not depend on the motion along the row: they are as in the steady state."""
    chain, drive = driven(0.5, friction_ratio=0.3)
    orbit = euler_orbit(chain, drive, STEPS, Preload.at_multiple(drive, 1.5, 1))
    assert orbit.lane.opens
    return orbit


def standing(frequency_ratio: float) -> PeriodicOrbit:
    """Den Hartog's oscillator beside a mass a million times as heavy: both may stand elsewhere, and move alike."""
    chain = one_cell(bound=4.0, inner_mass=1e6, chain_stiffness=50.0, inner_stiffness=50.0)
    return euler_orbit(chain, HarmonicForce(10.0, frequency_ratio * 10), 800)


@pytest.mark.parametrize(
    ("make", "most"),
    [
        (lambda: euler_orbit(*driven(0.1, damping_ratio=0.5, inner_damping_ratio=0.5), STEPS), 2.5),
        (opening, 100),
        (lambda: standing(0.8), 10),
        (lambda: standing(1.3), 10),
    ],
    ids=["well damped", "contacts open", "a mass that stands, below", "a mass that stands, above"],
)
def test_residual_is_hardly_amplified_by_dashpots_by_flights_and_by_offsets_that_last(make, most) -> None:
    assert 1 <= residual_amplification(make()) < most
