"""Error bars: how far a steady state of the Euler scheme is from that of the continuous motion.

The steady state is found with three step sizes, and `reference_lcp.accuracy.richardson` estimates the error from them.
What the residuals of the steady states and round-off leave open comes on top.
"""

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from reference_lcp.accuracy.resolution import amplitude_in_db, unresolved_amplitude
from reference_lcp.accuracy.richardson import richardson
from reference_lcp.chain.harmonic import PeriodicDrive
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.observables.stick_slip import Mode, Transition, stuck_fraction, transitions
from reference_lcp.observables.transition_matching import TimedTransition, match_transitions
from reference_lcp.observables.transmittance import decibel, transmittance
from reference_lcp.steady.amplification import residual_amplification
from reference_lcp.steady.limits import DEFAULT_PERIODS, DEFAULT_RESIDUAL
from reference_lcp.steady.orbits import PeriodicOrbit, periodic_orbits
from reference_lcp.stepping.euler_compiled import CompiledSimulation
from reference_lcp.validation import FloatArray

REFINEMENTS = (1, 2, 4)
"""Numbers of steps that are compared, over the fewest of them."""


@dataclass(frozen=True)
class ErrorBar:
    """Error of a steady state: that of the step, of the residual and of round-off.

    Parameters
    ----------
    transmittance_db
        The true transmittance lies within this distance of the computed one [dB]; infinite where the transmittance is
        below what can be resolved; NaN where a finer step found no steady state.
    floor_db
        Where the transmittance is below what can be resolved, the largest one that is consistent with the result
        [dB]; NaN where it is resolved, or a finer step found no steady state.
    stuck_fraction
        As `transmittance_db`, for the stuck fraction of each contact, shape (n,).
    transition_time
        The same for the time of each transition [s], in the order of `transitions`, shape (transitions,); NaN where a
        transition is undecided: not there with every step.
    missing_transitions
        Transitions that other steps show and the judged one does not: undecided too.
    order
        Order measured over three step sizes; NaN where differences vanish. Far from one, the steps are
        too coarse for the motion, or a grazing contact changes its mode between them.
    extrapolated_db
        Transmittance extrapolated to Δt → 0 from the two finest steps [dB]; NaN where it is not resolved.
    steps_per_period
        The step numbers that were compared.
    """

    transmittance_db: float
    floor_db: float
    stuck_fraction: FloatArray
    transition_time: FloatArray
    missing_transitions: list[Transition]
    order: float
    extrapolated_db: float
    steps_per_period: tuple[int, ...]

    @property
    def resolved(self) -> bool:
        """Whether the transmittance is above what residual and round-off can resolve."""
        return math.isnan(self.floor_db)

    def as_dict(self) -> dict[str, Any]:
        """Give the numbers, ready for JSON; what is not known is ``None``."""
        return {
            "error_bar_db": _known(self.transmittance_db),
            "floor_db": _known(self.floor_db),
            "error_bar_stuck_fraction": [_known(bar) for bar in self.stuck_fraction.tolist()],
            "missing_transitions": [change.as_dict() for change in self.missing_transitions],
            "order": _known(self.order),
            "extrapolated_db": _known(self.extrapolated_db),
        }


def measured_error_bar(
    orbit: PeriodicOrbit, *, tolerance: float = DEFAULT_RESIDUAL, max_periods: int = DEFAULT_PERIODS
) -> ErrorBar:
    """Measure the error of an orbit of the Euler scheme, from its step Δt and from Δt/2 and Δt/4.

    Parameters
    ----------
    orbit
        The result whose error is measured.
    tolerance, max_periods
        As for `periodic_orbits`, of the finer steps.

    Raises
    ------
    ParameterError
        If an argument is outside its range.
    """
    finer = []
    for factor in REFINEMENTS[1:]:
        lane = dataclasses.replace(orbit.lane, time_step=orbit.lane.time_step / factor)
        steps = orbit.trajectory.steps * factor
        finer += periodic_orbits(CompiledSimulation([lane]), steps, tolerance=tolerance, max_periods=max_periods)
    return error_bar([orbit, *finer])


def error_bar(orbits: Sequence[PeriodicOrbit], place: int = 0) -> ErrorBar:
    """Estimate the error of one of several orbits that differ in their steps.

    The error of the step is `richardson`'s; that of a stuck fraction and of the time of a transition has one step of
    resolution besides, and that of the transmittance what residual and round-off leave open.

    Parameters
    ----------
    orbits
        Of one chain under one drive, by ascending numbers of steps; at least two.
    place
        Index of the orbit that is judged.
    """
    judged, steps = orbits[place], tuple(orbit.trajectory.steps for orbit in orbits)
    stuck = [stuck_fraction(orbit) if orbit.converged else np.nan * stuck_fraction(orbit) for orbit in orbits]
    times, missing = _transition_times(orbits, place)
    return ErrorBar(
        **_transmittance_bar(orbits, place),
        stuck_fraction=richardson(steps, stuck, steps[place]).error + _sticks(judged) / steps[place],
        transition_time=richardson(steps, times, steps[place]).error + judged.lane.time_step,
        missing_transitions=missing,
        steps_per_period=steps,
    )


def _transmittance_bar(orbits: Sequence[PeriodicOrbit], place: int) -> dict[str, float]:
    """Give the fields of an `ErrorBar` that the transmittance decides."""
    steps = [orbit.trajectory.steps for orbit in orbits]
    amplitudes = np.array([transmittance(orbit) if orbit.converged else np.nan for orbit in orbits])
    unresolved = _unresolved_amplitude(orbits[place])
    if unresolved >= amplitudes[place]:
        largest = amplitudes[place] + unresolved + float(richardson(steps, amplitudes, steps[place]).error)
        distance = math.nan if math.isnan(largest) else math.inf
        return {
            "transmittance_db": distance,
            "floor_db": decibel(largest),
            "order": math.nan,
            "extrapolated_db": math.nan,
        }
    levels = [decibel(amplitude) for amplitude in amplitudes]
    estimate = richardson(steps, levels, steps[place])
    return {
        "transmittance_db": float(estimate.error) - amplitude_in_db(-unresolved, levels[place]),
        "floor_db": math.nan,
        "order": estimate.order,
        "extrapolated_db": float(estimate.extrapolated),
    }


def _unresolved_amplitude(orbit: PeriodicOrbit) -> float:
    """What residual and round-off leave open of the amplitude of an orbit, over the displacement scale."""
    steps = orbit.periods * orbit.trajectory.steps
    return unresolved_amplitude(orbit.residual, residual_amplification(orbit), steps, decibel(transmittance(orbit)))


def _sticks(orbit: PeriodicOrbit) -> FloatArray:
    """Sticks of each contact in a period, at least one, shape (n,): what each of them lasts is off by up to a step."""
    cells = [change.cell - 1 for change in transitions(orbit) if change.kind is Mode.STICK]
    return np.maximum(1, np.bincount(cells, minlength=orbit.lane.chain.cells)).astype(np.float64)


def _transition_times(orbits: Sequence[PeriodicOrbit], place: int) -> tuple[FloatArray, list[Transition]]:
    """Times [s] of the judged transitions with every step, shape (orbits, transitions), and those it does not have.

    A time is NaN where no transition matches.
    """
    judged = [change.timed for change in transitions(orbits[place])]
    period = orbits[place].lane.time_step * orbits[place].trajectory.steps
    times = np.full((len(orbits), len(judged)), np.nan)
    missing: list[TimedTransition] = []
    for row, orbit in zip(times, orbits, strict=True):
        if not orbit.converged:
            continue
        match = match_transitions([change.timed for change in transitions(orbit)], judged, period)
        for (_, expected), error in zip(match.pairs, match.time_errors, strict=True):
            row[judged.index(expected)] = expected[1] + error * period
        missing.extend(match_transitions(match.spurious, missing, period).spurious)
    return times, [Transition(cell, time, Mode(kind)) for cell, time, kind in sorted(missing)]


def euler_orbit(
    chain: Chain,
    drive: PeriodicDrive,
    steps: int,
    tolerance: float = DEFAULT_RESIDUAL,
    max_periods: int = DEFAULT_PERIODS,
) -> PeriodicOrbit:
    """Find the periodic orbit of the compiled Euler scheme with so many steps a period; see `periodic_orbits`."""
    simulation = CompiledSimulation([Lane.periodic(chain, drive, steps)])
    return periodic_orbits(simulation, steps, tolerance=tolerance, max_periods=max_periods)[0]


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None
