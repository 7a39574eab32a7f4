"""The one judge: a number with several step sizes, beside what is expected of it.

    |difference| <= error of what is expected + larger of (own error, error of the scheme at this step) + resolution

All errors of steps are those of `reference_lcp.accuracy.richardson`.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from reference_lcp.accuracy.richardson import SAFETY, richardson, richardson_error
from reference_lcp.validation import FloatArray
from scenarios.tasks.result import Result, ResultStatus, repetition
from scenarios.verdicts.finding import Metric
from scenarios.verdicts.verdict import Comparison, Tolerance, Verdict

COARSE_SHARE = 0.1
"""Part of what friction changes at all that the step of a variant may leave open.

With a tenth, friction that is missing altogether, or never lets go, is ten times what is allowed; curves at ten levels
of friction are told apart.
"""

Number = float | FloatArray
"""What is judged: a number, or an array whose largest difference counts."""


@dataclass(frozen=True)
class Steps:
    """What one simulation gives with several step sizes.

    Parameters
    ----------
    values
        Numbers, or arrays of one shape, by steps a period.
    at
        Number of steps whose value is judged; without it, the largest.
    limit
        What the values tend to for ever finer steps, where that is known: errors are then measured, not estimated.
    """

    values: Mapping[int, Number]
    at: int | None = None
    limit: Number | None = None

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
        scaled = np.array([_scaled(metric, self.values[count]) for count in steps])
        if self.limit is None and scaled.ndim == 1:
            return richardson_error(tuple(steps), tuple(scaled.tolist()), self.at)
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
    effect: float = math.inf,
) -> Comparison:
    """Compare what a variant gives with what is expected.

    Parameters
    ----------
    metric
        What is compared.
    values
        Of the variant, by steps; or why there are none, which is the verdict then.
    expected
        What is expected, a number or an array of the values' shape.
    bar
        Error bar of it, >= 0.
    scheme
        The reference's values at the steps of the variant; without it, the variant has its own error alone.
    resolution
        What neither can resolve, >= 0.
    own
        Least error that the variant's own value has, where it is known from something else than its steps.
    effect
        How much friction changes the number at all, see `decide`.
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
    metric: Metric, value: Number, expected: Number, tolerance: Tolerance, effect: float = math.inf
) -> Comparison:
    """Compare a value with its expected value and a tolerance; NaN on either side is inconclusive.

    Nothing is shown by a value that agrees while its step leaves open more than `COARSE_SHARE` of the `effect`: of how
    much friction changes the number at all, on the scale of the metric.
    """
    difference = metric_difference(metric, value, expected)
    if math.isnan(difference) or math.isnan(tolerance.allowed):
        return Comparison(Verdict.INCONCLUSIVE, "there is no number to compare", difference)
    verdict = Verdict.AGREE if abs(difference) <= tolerance.allowed else Verdict.DISAGREE
    space = f" {metric.unit}" if metric.unit else ""
    reason = f"difference {difference:+.2g}{space}, allowed {tolerance}"
    if verdict is Verdict.AGREE and tolerance.step > COARSE_SHARE * effect:
        verdict, reason = Verdict.TOO_COARSE, f"{reason}, of {effect:.2g}{space} that friction changes at all"
    return Comparison(verdict, reason, difference, tolerance.allowed, tolerance.resolution)


def metric_difference(metric: Metric, value: Number, expected: Number) -> float:
    """Difference on the scale of the metric; of arrays, the largest in size."""
    difference = np.subtract(_scaled(metric, value), _scaled(metric, expected))
    return float(difference) if difference.ndim == 0 else float(np.max(np.abs(difference)))


def certified(results: Iterable[Result]) -> bool:
    """Whether every search for a steady state ended with a certified one; also where none was made."""
    return not any(result.status in (ResultStatus.PERIOD_LIMIT, ResultStatus.DIVERGED) for result in results)


def missing(source: str, results: Iterable[Result]) -> Comparison | None:
    """Give the verdict where a result is missing; ``None`` where all steady states are certified, all motions finished.

    Parameters
    ----------
    source
        Begins the reason of what is inconclusive; empty for nothing.
    results
        What is needed for a comparison; the first that is not there counts.
    """
    for result in results:
        if result.status in (ResultStatus.CONVERGED, ResultStatus.FINISHED):
            continue
        if result.status is ResultStatus.BLOCKED:
            return Comparison(Verdict.BLOCKED, result.reason)
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
