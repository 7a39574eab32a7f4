"""Steady states of masses, springs and friction contacts that need not be a chain."""

import dataclasses
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from reference_lcp.chain.drives import HarmonicForce
from reference_lcp.chain.simulation import Lane, PeriodicOrbit, steps_per_period_for
from reference_lcp.defaults import DEFAULT_PERIODS, DEFAULT_RESIDUAL, EXACT_RESIDUAL, MINIMUM_STEPS_PER_PERIOD
from reference_lcp.errors import ParameterError, checked_choice
from reference_lcp.exact.exact_orbit import exact_orbit
from reference_lcp.lcp.systems import SINGULAR, MassSpringSystem, Piecewise, piecewise
from reference_lcp.observables.stick_slip import Transition, contact_modes, transitions_between
from reference_lcp.observables.transmittance import fundamental
from reference_lcp.schemes.euler import euler_simulation
from reference_lcp.steady.error_bar import SystemErrorBar, measured_error_bar
from reference_lcp.steady.orbits import periodic_orbits
from reference_lcp.validation import FloatArray, checked_count, checked_scalar

LONGEST_CYCLE = 12
"""Most periods of what repeats slowest after which all of it does."""

SAME_RATIO = 1e-9
"""Part by which a frequency may miss a whole multiple of another: decimals as people type them."""


@dataclass(frozen=True, repr=False)
class SystemSteadyState:
    """A steady state of a system and what is read from it; printed as one line."""

    orbit: PeriodicOrbit
    """One period and its residual."""
    amplitude: FloatArray
    """Half of the distance between the ends of the way of every body [m], shape (f,)."""
    phase: FloatArray
    """By which the fundamental of every displacement is ahead of sin(2πt / T) [rad], in (−π, π], shape (f,)."""
    stuck_fraction: FloatArray
    """Part of the period that each contact sticks, shape (c,)."""
    transitions: list[Transition]
    """Changes between stick and slip over the period; their cell is the contact, from 1."""
    error_bar: SystemErrorBar | None = None
    """Of the Euler scheme; ``None`` of the exact motion, or if it was not requested."""

    def __repr__(self) -> str:
        """Say in one line how far the bodies swing, and which part of the time the contacts stick."""
        status = "" if self.orbit.converged else f"not certified ({self.orbit.status}): "
        numbers = (" ".join(f"{own:.6g}" for own in row) for row in (self.amplitude, self.phase, self.stuck_fraction))
        return f"<SystemSteadyState {status}amplitudes {{}} m, phases {{}} rad, stuck {{}}>".format(*numbers)


def system_steady_state(
    system: MassSpringSystem,
    period: float | None = None,
    *,
    steps_per_period: int = MINIMUM_STEPS_PER_PERIOD,
    solver: str = "exact",
    tolerance: float | None = None,
    max_periods: int = DEFAULT_PERIODS,
    with_error_bar: bool = True,
) -> SystemSteadyState:
    """Find the steady state of a system; arguments are those of `steady_state`."""
    checked_choice("solver", solver, ["compiled", "exact"])
    residual = DEFAULT_RESIDUAL if solver == "compiled" else EXACT_RESIDUAL
    residual = residual if tolerance is None else checked_scalar("tolerance", tolerance, "> 0")
    checked_count("max_periods", max_periods)
    chain: Any = system  # what searches take of a chain, a system has too
    drive = repetition_of(system, period)
    steps = steps_per_period_for(chain, drive, steps_per_period)
    if solver == "exact":
        orbit, exact = exact_orbit(chain, drive, steps_per_period=steps, tolerance=residual, max_periods=max_periods)
        reading = exact.amplitude, np.angle(exact.harmonic()), exact.stuck_fraction, exact.transitions
        return SystemSteadyState(orbit, *reading)
    simulation = euler_simulation([Lane.periodic(chain, drive, steps)])
    orbit = periodic_orbits(simulation, steps, tolerance=residual, max_periods=max_periods)[0]
    modes, positions = contact_modes(orbit), orbit.trajectory.positions
    motion = np.ptp(positions, axis=0) / 2, np.angle(fundamental(positions))
    state = SystemSteadyState(orbit, *motion, np.mean(modes == 0, axis=0), transitions_between(modes, orbit))
    if not with_error_bar:
        return state
    bar: Any = measured_error_bar(orbit, tolerance=residual, max_periods=max_periods)
    return dataclasses.replace(state, error_bar=bar)


def repetition_of(system: MassSpringSystem, period: float | None) -> HarmonicForce:
    """Find how a system repeats, as a drive of its frequency and length; refused where it has no steady state."""
    repeated: list[tuple[str, float]] = []
    for name, signal in _signals(system):
        (piece, *others) = signal.harmonics
        if others:
            raise ParameterError(f"{name} switches at {signal.switches[0]:g} s; allowed: what repeats for ever")
        if piece.rate:
            raise ParameterError(f"{name} grows by {piece.rate:g} N/s for ever; allowed: what repeats")
        if piece.amplitude and piece.angular_frequency:
            repeated.append((name, piece.angular_frequency))
    if not repeated:
        raise ParameterError("nothing in the system repeats; allowed: a Harmonic or a Motion with an amplitude")
    longest = 2 * np.pi / min(frequency for _, frequency in repeated)
    times = [longest * k for k in range(1, LONGEST_CYCLE + 1)]
    for time in times if period is None else [checked_scalar("period", period, "> 0")]:
        turns = [(name, frequency * time / (2 * np.pi)) for name, frequency in repeated]
        odd = [own for own in turns if not math.isclose(own[1], max(1, round(own[1])), rel_tol=SAME_RATIO)]
        if not odd:
            break
    else:
        name, count = odd[0]
        raise ParameterError(f"{name} repeats {count:g} times in {time:g} s; allowed: a period of whole numbers")
    _check_stands(system)
    for frequency in {frequency for _, frequency in repeated}:
        _check_bounded(system, frequency)
    return HarmonicForce(1.0, 2 * np.pi / time, _length(system))


def _signals(system: MassSpringSystem) -> Iterator[tuple[str, Piecewise]]:
    """Give what changes in time, with its name."""
    for body, signal in system.loads:
        yield f"force on body {body}", signal
    for contact, signal in enumerate(system.normal_signals):
        yield f"normal force of contact {contact}", signal
    for contact, speed in enumerate(system.surface_speeds):
        yield f"ground under contact {contact}", piecewise(speed)


def _check_stands(system: MassSpringSystem) -> None:
    """Refuse a body that no spring brings back."""
    values, shapes = np.linalg.eigh(system.per_mass(system.stiffness_matrix))
    if values[0] <= SINGULAR * values[-1]:
        body = int(np.argmax(np.abs(shapes[:, 0])))
        raise ParameterError(
            f"body {body} floats, so that it has no steady state; allowed: a spring that brings it back"
        )


def _check_bounded(system: MassSpringSystem, frequency: float) -> None:
    """Refuse a resonance [rad/s] without dashpots in which friction takes up less than the forces bring in."""
    scales, load = 1 / np.sqrt(system.masses), np.zeros(system.freedoms, complex)
    for body, signal in system.loads:
        (piece,) = signal.harmonics
        if piece.angular_frequency == frequency:
            load[body] += piece.amplitude * np.exp(1j * piece.phase)
    stiffness, damping = map(system.per_mass, (system.stiffness_matrix, system.damping_matrix))
    _, sizes, shapes = np.linalg.svd(stiffness + 1j * frequency * damping - frequency**2 * np.eye(system.freedoms))
    if sizes[-1] > SINGULAR * np.linalg.norm(stiffness, 2):
        return
    shape = scales * shapes[-1].conj()
    brought, taken = np.pi * abs(shape.conj() @ load), 4 * system.friction_bound @ abs(system.directions.T @ shape)
    if brought > taken:
        body = int(np.argmax(np.abs(shape)))
        raise ParameterError(
            f"body {body} is at an undamped resonance of {frequency:g} rad/s, and friction takes up "
            f"{taken / brought:.3g} of what forces bring in; allowed: a dashpot, more friction, or another frequency"
        )


def _length(system: MassSpringSystem) -> float:
    """Give the largest elongation that the forces would cause at rest [m]; one metre where there is none."""
    stiffness = np.diag(system.stiffness_matrix)
    pieces = [(body, signal.harmonics[0]) for body, signal in system.loads]
    swings = [abs(piece.amplitude) / stiffness[body] for body, piece in pieces]
    swings += [abs(own.amplitude) / own.angular_frequency for own in system.surface_speeds if own.amplitude]
    means = [abs(piece.mean) / stiffness[body] for body, piece in pieces]
    return max(swings, default=0.0) or max(means, default=0.0) or 1.0
