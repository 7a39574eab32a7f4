"""Error bars: how far a steady state of the Euler scheme is from that of the continuous motion.

The steady state is found with three step sizes, and `reference_lcp.steady.richardson` estimates the error from them.
What the residuals of the steady states and round-off leave open comes on top.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import PeriodicOrbit
from reference_lcp.defaults import DEFAULT_PERIODS, DEFAULT_RESIDUAL
from reference_lcp.observables.stick_slip import (
    Mode,
    TimedTransition,
    Transition,
    contact_modes,
    match_transitions,
    transitions_between,
)
from reference_lcp.observables.transmittance import complex_transmittance, decibel, fundamental
from reference_lcp.steady.neighbours import PeriodInverse, refined_orbits
from reference_lcp.steady.richardson import SAFETY, amplitude_in_db, richardson, unresolved_amplitude
from reference_lcp.validation import FloatArray, checked_count, checked_scalar

REFINEMENTS = (1, 2, 4)
"""Numbers of steps that are compared, over the fewest of them."""

MARGINAL_STEPS = 3
"""Steps before a reversal in which a force below its bound would have held the contact, and which leave open whether it
sticks there for a moment: the scheme stops contacts a step or two early or late, and steps of any size may agree."""


@dataclass(frozen=True)
class ErrorBar:
    """Error of a steady state: that of the step, of the residual and of round-off."""

    transmittance_db: float
    """Largest distance of the true transmittance [dB]; inf where it is not resolved, NaN where a finer step failed."""
    floor_db: float
    """Where the transmittance is not resolved, the largest one that is consistent with the result [dB]; else NaN."""
    phase: float
    """As `transmittance_db`, for the phase of the last outer mass's fundamental [rad]."""
    stuck_fraction: FloatArray
    """As `transmittance_db`, for the stuck fraction of each contact, shape (n,)."""
    transition_time: FloatArray
    """The same for the time of each of `transitions` [s]; NaN where it is inconclusive: not there with every step."""
    missing_transitions: list[Transition]
    """Transitions that other steps show and the judged one does not: inconclusive too.

    So are sticks at a reversal that is `MARGINAL_STEPS` from one.
    """
    order: float
    """Measured over three step sizes, see `Estimate`."""
    extrapolated_db: float
    """Transmittance extrapolated to Δt → 0 from the two finest steps [dB]; NaN where it is not resolved."""
    steps_per_period: tuple[int, ...]
    """The step numbers that were compared."""

    @property
    def resolved(self) -> bool:
        """Whether the transmittance is above what residual and round-off can resolve."""
        return math.isnan(self.floor_db)


@dataclass(frozen=True)
class SystemErrorBar:
    """Error of a steady state of bodies, as `ErrorBar` of a chain's."""

    amplitude: FloatArray
    """Largest distance of the true amplitude of every body [m], shape (f,)."""
    phase: FloatArray
    """The same for the phase of its fundamental [rad], shape (f,)."""
    stuck_fraction: FloatArray
    transition_time: FloatArray
    missing_transitions: list[Transition]
    steps_per_period: tuple[int, ...]


def measured_error_bar(
    orbit: PeriodicOrbit, *, tolerance: float = DEFAULT_RESIDUAL, max_periods: int = DEFAULT_PERIODS
) -> Any:
    """Measure the error of an orbit of the Euler scheme, from its step Δt and from Δt/2 and Δt/4.

    Parameters
    ----------
    orbit
        The result whose error is measured.
    tolerance, max_periods
        As for `periodic_orbits`, of the finer steps.

    Returns
    -------
    ErrorBar or SystemErrorBar
        The latter of bodies that are no chain.

    Raises
    ------
    ParameterError
        If an argument is outside its range.
    """
    checked_scalar("tolerance", tolerance, "> 0")
    checked_count("max_periods", max_periods)
    inverse = PeriodInverse.of([orbit])
    finer = refined_orbits(orbit, REFINEMENTS[1:], inverse, tolerance=tolerance, max_periods=max_periods)
    return error_bar_of([orbit, *finer], 0, float(inverse.amplification[0]))


def error_bar_of(orbits: Sequence[PeriodicOrbit], place: int, amplification: float) -> Any:
    """Estimate the error of one of the orbits of a point, by ascending numbers of steps."""
    judged, steps, cells = orbits[place], [own.trajectory.steps for own in orbits], orbits[0].trajectory.cells
    modes = [contact_modes(orbit) for orbit in orbits]
    changes = list(map(transitions_between, modes, orbits))
    stuck = np.array([np.mean(read == 0, axis=0) for read in modes])
    stuck[[not orbit.converged for orbit in orbits]] = np.nan
    marginal = _marginal_reversals(judged, modes[place], changes[place])
    sticks = _sticks(changes[place], cells) + _count(marginal, cells) * MARGINAL_STEPS
    times, missing = _transition_times(orbits, changes, place, marginal)
    kind, level = (
        (ErrorBar, _transmittance_bar) if isinstance(judged.lane.chain, Chain) else (SystemErrorBar, _amplitude_bar)
    )
    return kind(
        **level(orbits, steps, place, amplification),
        stuck_fraction=richardson(steps, stuck, steps[place]).error + SAFETY * sticks / steps[place],
        transition_time=richardson(steps, times, steps[place]).error + judged.lane.time_step,
        missing_transitions=missing,
        steps_per_period=tuple(steps),
    )


def _transmittance_bar(
    orbits: Sequence[PeriodicOrbit], steps: Sequence[int], place: int, amplification: float
) -> dict[str, float]:
    """Give the fields of an `ErrorBar` that the transmittance decides."""
    ratios = np.array([complex_transmittance(orbit) if orbit.converged else np.nan for orbit in orbits])
    amplitudes, phases = np.abs(ratios), np.angle(ratios * np.conj(ratios[place]))
    with np.errstate(divide="ignore"):
        levels = 20 * np.log10(amplitudes)
    by_amplitude, by_level, by_phase = (richardson(steps, own, steps[place]) for own in (amplitudes, levels, phases))
    orbit, amplitude, level = orbits[place], float(amplitudes[place]), float(levels[place])
    unresolved = unresolved_amplitude(orbit.residual, amplification, orbit.periods * steps[place], level)
    bar = dict.fromkeys(("transmittance_db", "phase", "floor_db", "order", "extrapolated_db"), math.nan)
    if unresolved >= amplitude:
        largest = amplitude + unresolved + float(by_amplitude.error)
        bar["transmittance_db"] = bar["phase"] = math.nan if math.isnan(largest) else math.inf
        return bar | {"floor_db": decibel(largest)}
    bar["transmittance_db"] = float(by_level.error) - amplitude_in_db(-unresolved, level)
    bar["phase"] = float(by_phase.error) + math.asin(unresolved / amplitude)
    return bar | {"order": float(by_level.order), "extrapolated_db": float(by_level.extrapolated)}


def _amplitude_bar(
    orbits: Sequence[PeriodicOrbit], steps: Sequence[int], place: int, amplification: float
) -> dict[str, FloatArray]:
    """Give the fields of a `SystemErrorBar` that the amplitudes decide."""
    known = [1.0 if orbit.converged else np.nan for orbit in orbits]
    motions = [orbit.trajectory.positions for orbit in orbits]
    swings = [own * np.ptp(motion, axis=0) / 2 for own, motion in zip(known, motions, strict=True)]
    waves = [own * fundamental(motion) for own, motion in zip(known, motions, strict=True)]
    turns = [np.angle(wave * np.conj(waves[place])) for wave in waves]
    orbit, size = orbits[place], np.maximum(np.abs(waves[place]), np.finfo(float).tiny)
    left = unresolved_amplitude(orbit.residual, amplification, orbit.periods * steps[place], 0.0)
    left *= orbit.lane.drive.displacement_scale(orbit.lane.chain)
    between = swings[place] * (1 - np.cos(np.pi / steps[place]))  # what a sine goes beyond its rows
    phase = richardson(steps, turns, steps[place]).error + np.arcsin(np.minimum(1.0, left / size))
    amplitude = richardson(steps, swings, steps[place]).error + left + between
    return {"amplitude": amplitude, "phase": np.minimum(phase, np.pi)}


def _sticks(changes: Sequence[Transition], cells: int) -> FloatArray:
    """Sticks of each contact in a period, at least one, shape (n,): what each of them lasts is off by up to a step."""
    return np.maximum(1.0, _count([change for change in changes if change.kind == Mode.STICK], cells))


def _count(changes: Sequence[Transition], cells: int) -> FloatArray:
    """How many of the changes each contact has, shape (n,)."""
    return np.bincount([change.cell - 1 for change in changes], minlength=cells).astype(np.float64)


def _marginal_reversals(
    orbit: PeriodicOrbit, modes: NDArray[np.int8], changes: Sequence[Transition]
) -> list[Transition]:
    """Reversals in which a contact may stick for less than the steps show, see `MARGINAL_STEPS`.

    The force that would have held a contact is that on it, less what has changed its relative velocity.
    """
    trajectory, chain, time_step = orbit.trajectory, orbit.lane.chain, orbit.lane.time_step
    steps, cells = np.nonzero(modes * np.roll(modes, 1, axis=0) == -1)
    before = (steps - np.arange(1, MARGINAL_STEPS + 1)[:, None]) % trajectory.steps
    slip = trajectory.relative_velocity
    held = (
        trajectory.friction[before, cells]
        - chain.contact_mass[cells] * (slip[before, cells] - slip[before - 1, cells]) / time_step
    )
    within = np.abs(held) < chain.friction_coefficient[cells] * trajectory.normal_force[before, cells]
    marginal = np.any(within, axis=0)
    found = set(zip(steps[marginal].tolist(), cells[marginal].tolist(), strict=True))
    return [
        change for change in changes if (round(change.time / time_step) % trajectory.steps, change.cell - 1) in found
    ]


def _transition_times(
    orbits: Sequence[PeriodicOrbit], observed: Sequence[list[Transition]], place: int, marginal: Sequence[Transition]
) -> tuple[FloatArray, list[Transition]]:
    """Times [s] of the judged transitions with every step, NaN without a match, shape (orbits, transitions); others."""
    judged = observed[place]
    index: dict[TimedTransition, int] = {change: k for k, change in enumerate(judged)}
    period = orbits[place].lane.time_step * orbits[place].trajectory.steps
    times = np.full((len(orbits), len(judged)), np.nan)
    missing: list[TimedTransition] = [(change.cell, change.time, Mode.STICK) for change in marginal]
    for number, orbit in enumerate(orbits):
        if not orbit.converged:
            continue
        if number == place:
            times[number] = [change.time for change in judged]
            continue
        match = match_transitions(observed[number], judged, period)
        for expected, error in match.errors.items():
            times[number, index[expected]] = expected[1] + error * period
        if match.spurious:
            missing.extend(match_transitions(match.spurious, missing, period).spurious)
    times[:, [index[change] for change in marginal]] = np.nan
    return times, [Transition(cell, time, Mode(kind)) for cell, time, kind in sorted(missing)]
