"""The one judge: a number with several step sizes, beside what is expected of it.

    |difference| <= error of what is expected + larger of (own error, error of the scheme at this step) + resolution

All errors of steps are those of `reference_lcp.steady.richardson`.
"""

import cmath
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from multibody_xval.scenarios.runs.result import Result, ResultStatus, repetition
from multibody_xval.scenarios.verdicts.finding import (
    PHASE,
    TRANSMITTANCE,
    Comparison,
    Metric,
    Tolerance,
    Verdict,
    amplitude_in_degrees,
    phase_reader,
)
from reference_lcp.chain.drives import PeriodicDrive
from reference_lcp.chain.linear_response import frictionless_response, stuck_response
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.observables.transmittance import decibel
from reference_lcp.steady.richardson import SAFETY, amplitude_in_db, richardson, richardson_error
from reference_lcp.validation import FloatArray

FrictionEffect = Mapping[Metric, float]
"""How far transmittance [dB] and phase [°] of a steady state may be from the farther one of the two linear limits: how
much friction changes them at all.

Between contacts that slide freely and contacts that never slide, a linear chain each, lies what friction can do. An
engine whose own step leaves open a large part of that has not been tested by a comparison that it passes.
"""


def friction_effect(chain: Chain, drive: PeriodicDrive, transmittance_db: float, phase: float) -> FrictionEffect:
    """Give how far a transmittance [dB] and its phase [rad] are from the linear limit that is farther from each."""
    scale = drive.displacement_scale(chain)
    responses = frictionless_response(chain, drive), stuck_response(chain, drive)
    limits = [complex(response[chain.cells - 1]) / scale for response in responses]
    level = TRANSMITTANCE.scaled(transmittance_db)
    return {
        TRANSMITTANCE: max(abs(TRANSMITTANCE.scaled(decibel(abs(limit))) - level) for limit in limits),
        PHASE: max(abs(math.degrees(math.remainder(cmath.phase(limit) - phase, 2 * math.pi))) for limit in limits),
    }


Read = Callable[[Result], float]
"""Gives a number of a result."""


def response_readers(transmittance_db: float, phase: float) -> dict[Metric, Read]:
    """Give what is read of results beside an expected transmittance [dB] and phase [rad]; no phase if that is NaN."""
    level: dict[Metric, Read] = {TRANSMITTANCE: lambda result: result.transmittance_db}
    return level if math.isnan(phase) else level | {PHASE: phase_reader(phase, transmittance_db)}


def of_amplitude(metric: Metric, amplitude: float, transmittance_db: float) -> float:
    """Give what a change of the amplitude, over U0, makes of level or phase near this transmittance."""
    return (amplitude_in_db if metric == TRANSMITTANCE else amplitude_in_degrees)(amplitude, transmittance_db)


def of_response(comparison: Comparison, metric: Metric, transmittance_db: float) -> Comparison:
    """Give a comparison of level or phase with what a change of the amplitude makes of it; see `per_amplitude`."""
    if metric == TRANSMITTANCE:
        return comparison
    return replace(comparison, per_amplitude=amplitude_in_degrees(1.0, transmittance_db))


COARSE_SHARE = 0.1
"""Part of what friction changes at all that errors of steps may leave open.

With a tenth, friction that is missing altogether, or never lets go, is ten times what is allowed; curves at ten levels
of friction are told apart.
"""

AMPLITUDE_DB = 20 / math.log(10)
"""Size of an amplitude on the scale of dB [dB]: what a change by a small part of it makes there, over that part."""

Number = float | FloatArray
"""What is judged: a number, or an array whose largest difference counts."""


@dataclass(frozen=True)
class Steps:
    """What one simulation gives with several step sizes."""

    values: Mapping[int, Number]
    """Numbers, or arrays of one shape, by steps a period."""
    at: int | None = None
    """Number of steps whose value is judged; without it, the largest."""
    limit: Number | None = None
    """What the values tend to for ever finer steps, where that is known: errors are then measured, not estimated."""

    @property
    def judged(self) -> Number:
        """The value that is judged."""
        return self.values[max(self.values) if self.at is None else self.at]

    def error(self, metric: Metric) -> float:
        """Estimate the error of the judged value on the scale of the metric; zero where one step only says nothing.

        Of values whose limit is known it is `SAFETY` times the largest error of first order that any of them shows.
        """
        if len(self.values) == 1 and self.limit is None:
            return 0.0
        steps = sorted(self.values)
        values = [_scaled(metric, self.values[count]) for count in steps]
        if self.limit is None and not isinstance(values[0], np.ndarray):
            return richardson_error(tuple(steps), tuple(map(float, values)), self.at)
        scaled = np.array(values)
        if self.limit is None:
            return float(np.max(richardson(steps, scaled, self.at).error))
        judged = steps[-1] if self.at is None else self.at
        errors = np.abs(scaled - _scaled(metric, self.limit))
        return SAFETY * float(np.max(np.max(errors.reshape(len(steps), -1), axis=1) * np.array(steps) / judged))


def judge(
    metric: Metric,
    values: Steps | Comparison,
    expected: Number,
    *,
    bar: float = 0.0,
    scheme: Steps | None = None,
    resolution: float = 0.0,
    own: float = 0.0,
    effect: float | None = None,
) -> Comparison:
    """Compare what a variant gives by steps, or why it gives nothing, with what is expected, which has the error `bar`.

    Without the reference's values at these steps, `scheme`, the variant has its own error alone; `own` is the least
    error of its value, where that is known from something else than its steps. For `effect` see `decide`.
    """
    if isinstance(values, Comparison):
        return values
    tolerance = Tolerance(
        reference=bar,
        engine=max(values.error(metric), own),
        scheme=0.0 if scheme is None else scheme.error(metric),
        resolution=resolution,
    )
    return decide(metric, values.judged, expected, tolerance, effect)


def decide(
    metric: Metric, value: Number, expected: Number, tolerance: Tolerance, effect: float | None = None
) -> Comparison:
    """Compare a value with its expected value and a tolerance; NaN on either side is inconclusive.

    Nothing is shown by a value that agrees while errors of steps leave open more than `COARSE_SHARE` of the `effect`:
    of how much friction changes the number at all, on the scale of the metric. Without it, the metric's counts, or the
    size of what is expected: beside zero, no error of a step is small.
    """
    difference = metric_difference(metric, value, expected)
    if math.isnan(difference) or math.isnan(tolerance.allowed):
        return Comparison(Verdict.INCONCLUSIVE, "there is no number to compare", difference)
    verdict = Verdict.AGREE if abs(difference) <= tolerance.allowed else Verdict.DISAGREE
    space = f" {metric.unit}" if metric.unit else ""
    reason = f"difference {difference:+.2g}{space}, allowed {tolerance}"
    known = metric.effect if effect is None else effect
    at_stake = _size(metric, expected) if known is None else known
    if verdict is Verdict.AGREE and tolerance.step > COARSE_SHARE * at_stake:
        what = "is expected" if known is None else "friction changes at all"
        verdict, reason = Verdict.TOO_COARSE, f"{reason}, of {at_stake:.2g}{space} that {what}"
    return Comparison(verdict, reason, difference, tolerance.allowed, tolerance.resolution)


def _size(metric: Metric, expected: Number) -> float:
    """Give the size of what is expected on the scale of the metric: in dB, that of the amplitude."""
    return AMPLITUDE_DB if metric.unit == "dB" else float(np.max(np.abs(expected)))


def metric_difference(metric: Metric, value: Number, expected: Number) -> float:
    """Difference on the scale of the metric; of arrays, the largest in size."""
    difference = _scaled(metric, value) - _scaled(metric, expected)
    return float(np.max(np.abs(difference))) if isinstance(difference, np.ndarray) else float(difference)


def certified(results: Iterable[Result]) -> bool:
    """Whether every search for a steady state ended with a certified one; also where none was made."""
    return not any(result.status in (ResultStatus.PERIOD_LIMIT, ResultStatus.DIVERGED) for result in results)


def missing(source: str, results: Iterable[Result]) -> Comparison | None:
    """Give the verdict of the first result that is missing; ``None`` where all are certified or finished.

    The `source` begins the reason of what is inconclusive.
    """
    for result in results:
        if result.status in (ResultStatus.CONVERGED, ResultStatus.FINISHED):
            continue
        if result.status is ResultStatus.BLOCKED:
            return Comparison(Verdict.BLOCKED, result.reason, failed=result.failed)
        if result.status is ResultStatus.MISSING:
            source, reason = source.partition(" at ")[0], result.reason
        else:
            reason = f"{result.status} after {result.periods} periods, residual {result.residual:.1e}"
            reason += repetition(result.multiple)
        text = f"{source}: {reason}" if source else reason
        return Comparison(Verdict.INCONCLUSIVE, text, certified=certified([result]))
    return None


def _scaled(metric: Metric, value: Number) -> Number:
    """Give a number, or every one of an array, on the scale of the metric."""
    if metric.floor_db == -math.inf:
        return value
    return np.vectorize(metric.scaled, otypes=[float])(value) if isinstance(value, np.ndarray) else metric.scaled(value)
