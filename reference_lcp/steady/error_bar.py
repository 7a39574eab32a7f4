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
from reference_lcp.chain.simulation import PeriodicOrbit, common_cells
from reference_lcp.defaults import DEFAULT_PERIODS, DEFAULT_RESIDUAL
from reference_lcp.errors import ParameterError
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

BATCH = 450
"""Cells of orbits that are refined together: records of more, over 32 MB, are new memory each time, which is slow."""


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
) -> ErrorBar:
    """Measure the error of one orbit; see `measured_error_bars`."""
    return measured_error_bars([orbit], tolerance=tolerance, max_periods=max_periods)[0]


def measured_error_bars(
    orbits: Sequence[PeriodicOrbit], *, tolerance: float = DEFAULT_RESIDUAL, max_periods: int = DEFAULT_PERIODS
) -> list[ErrorBar]:
    """Measure the errors of orbits of the Euler scheme, from their step Δt and from Δt/2 and Δt/4, together.

    Parameters
    ----------
    orbits
        The results whose errors are measured: of chains of one length, with one number of steps a period.
    tolerance, max_periods
        As for `periodic_orbits`, of the finer steps.

    Raises
    ------
    ParameterError
        If an argument is outside its range, or lengths or numbers of steps differ.
    """
    checked_scalar("tolerance", tolerance, "> 0")
    checked_count("max_periods", max_periods)
    if not orbits:
        return []
    together = max(1, BATCH // max(1, common_cells([orbit.lane for orbit in orbits])))
    steps = {orbit.trajectory.steps for orbit in orbits}
    if len(steps) > 1:
        raise ParameterError(f"a batch holds periods of {sorted(steps)} steps; allowed: one number of steps")
    bars: list[ErrorBar] = []
    for first in range(0, len(orbits), together):
        some = orbits[first : first + together]
        inverse = PeriodInverse.of(some)
        finer = refined_orbits(some, REFINEMENTS[1:], inverse, tolerance=tolerance, max_periods=max_periods)
        bars += error_bars_of([some, *finer], 0, inverse.amplification)
    return bars


def error_bars_of(ladder: Sequence[Sequence[PeriodicOrbit]], place: int, amplification: FloatArray) -> list[Any]:
    """Estimate the errors of the orbits in one place of a ladder: for each number of steps, one orbit a point."""
    chains = isinstance(ladder[0][0].lane.chain, Chain)
    kind: Any = ErrorBar if chains else SystemErrorBar
    levels: Any = _transmittance_bars if chains else _amplitude_bars
    judged, steps = ladder[place], tuple(orbits[0].trajectory.steps for orbits in ladder)
    modes = [[contact_modes(orbit) for orbit in orbits] for orbits in ladder]
    changes = [list(map(transitions_between, *row)) for row in zip(modes, ladder, strict=True)]
    stuck = np.array([[np.mean(read == 0, axis=0) for read in row] for row in modes])
    stuck[~np.array([[orbit.converged for orbit in orbits] for orbits in ladder])] = np.nan
    sticks = np.array([_sticks(row, stuck.shape[2]) for row in changes[place]])
    marginal = [
        _marginal_reversals(orbit, read, row)
        for orbit, read, row in zip(judged, modes[place], changes[place], strict=True)
    ]
    sticks += [_count(row, stuck.shape[2]) * MARGINAL_STEPS for row in marginal]
    of_stuck = richardson(steps, stuck, steps[place]).error + SAFETY * sticks / steps[place]
    matched = [
        _transition_times(orbits, row, place, own)
        for orbits, row, own in zip(zip(*ladder, strict=True), zip(*changes, strict=True), marginal, strict=True)
    ]
    times = richardson(steps, np.hstack([times for times, _ in matched]), steps[place]).error
    of_times = np.split(times, np.cumsum([part.shape[1] for part, _ in matched])[:-1])
    return [
        kind(
            **level,
            stuck_fraction=fraction,
            transition_time=time + orbit.lane.time_step,
            missing_transitions=missing,
            steps_per_period=steps,
        )
        for level, fraction, time, (_, missing), orbit in zip(
            levels(ladder, place, amplification), of_stuck, of_times, matched, judged, strict=True
        )
    ]


def _transmittance_bars(
    ladder: Sequence[Sequence[PeriodicOrbit]], place: int, amplification: FloatArray
) -> list[dict[str, float]]:
    """Give the fields of each `ErrorBar` that the transmittance decides."""
    steps = [orbits[0].trajectory.steps for orbits in ladder]
    ratios = np.array(
        [[complex_transmittance(orbit) if orbit.converged else np.nan for orbit in orbits] for orbits in ladder]
    )
    amplitudes = np.abs(ratios)
    with np.errstate(divide="ignore"):
        levels = 20 * np.log10(amplitudes)
    phases = np.angle(ratios * np.conj(ratios[place]))
    by_amplitude, by_level, by_phase = (
        richardson(steps, values, steps[place]) for values in (amplitudes, levels, phases)
    )
    bars = []
    for k, orbit in enumerate(ladder[place]):
        simulated, level = orbit.periods * orbit.trajectory.steps, float(levels[place, k])
        unresolved = unresolved_amplitude(orbit.residual, float(amplification[k]), simulated, level)
        bar = dict.fromkeys(("transmittance_db", "phase", "floor_db", "order", "extrapolated_db"), math.nan)
        if unresolved >= amplitudes[place, k]:
            largest = amplitudes[place, k] + unresolved + by_amplitude.error[k]
            bar |= {"transmittance_db": math.nan if math.isnan(largest) else math.inf, "floor_db": decibel(largest)}
            bar["phase"] = bar["transmittance_db"]
        else:
            bar["transmittance_db"] = float(by_level.error[k]) - amplitude_in_db(-unresolved, level)
            bar["phase"] = float(by_phase.error[k]) + math.asin(unresolved / amplitudes[place, k])
            bar |= {"order": float(by_level.order[k]), "extrapolated_db": float(by_level.extrapolated[k])}
        bars.append(bar)
    return bars


def _amplitude_bars(
    ladder: Sequence[Sequence[PeriodicOrbit]], place: int, amplification: FloatArray
) -> list[dict[str, FloatArray]]:
    """Give the fields of each `SystemErrorBar` that the amplitudes decide."""
    steps, bars = [orbits[0].trajectory.steps for orbits in ladder], []
    for growth, orbits in zip(amplification.tolist(), zip(*ladder, strict=True), strict=True):
        known = [1.0 if orbit.converged else np.nan for orbit in orbits]
        motions = [orbit.trajectory.positions for orbit in orbits]
        swings = [own * np.ptp(motion, axis=0) / 2 for own, motion in zip(known, motions, strict=True)]
        waves = [own * fundamental(motion) for own, motion in zip(known, motions, strict=True)]
        turns = [np.angle(wave * np.conj(waves[place])) for wave in waves]
        orbit, size = orbits[place], np.maximum(np.abs(waves[place]), np.finfo(float).tiny)
        left = unresolved_amplitude(orbit.residual, growth, orbit.periods * orbit.trajectory.steps, 0.0)
        left *= orbit.lane.drive.displacement_scale(orbit.lane.chain)
        between = swings[place] * (1 - np.cos(np.pi / steps[place]))  # what a sine goes beyond its rows
        phase = richardson(steps, turns, steps[place]).error + np.arcsin(np.minimum(1.0, left / size))
        amplitude = richardson(steps, swings, steps[place]).error + left + between
        bars.append({"amplitude": amplitude, "phase": np.minimum(phase, np.pi)})
    return bars


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
