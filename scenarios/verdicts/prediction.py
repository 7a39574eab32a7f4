"""Disagreements that the engine's law predicts: number by number, and step by step over a period.

A disagreement is *as its law predicts* where (a) a period of the engine equals the law's from the same state within the
bound that the law states, and (b) the number equals that of the law's own motion within what both leave open. A steady
state that is not certified is as its law predicts where the law has none either.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from multibody_xval.engines.interface.law import ROUND_OFF_PERIOD
from multibody_xval.engines.interface.registry import law_of
from multibody_xval.engines.shared.law_limit import law_fault
from multibody_xval.scenarios.runs.result import Result, ResultStatus
from multibody_xval.scenarios.runs.task import SteadyStateTask
from multibody_xval.scenarios.verdicts.finding import Finding, Prediction, Verdict
from multibody_xval.scenarios.verdicts.judge import metric_difference
from reference_lcp.steady.richardson import amplitude_in_db

PERIODS_OF_ERROR = 400.0
"""Periods whose differences between engine and law add up at most, where that is not measured: motions never drift
apart, the longest of the catalogue have 320 periods. In a steady state what is left of them is measured, see `gain`."""


@dataclass(frozen=True)
class LawPeriod:
    """How far an engine is from its law after a period from the same state, over the displacement scale."""

    distance: float
    """Largest difference of positions; NaN, which no bound allows, where there is none."""
    bound: float
    reason: str = ""
    """Why there is no distance, or one that is larger than the bound, where that is known; empty elsewhere."""
    gain: float = PERIODS_OF_ERROR
    """How many times the distance of a period is left in a number."""

    @classmethod
    def of(cls, task: SteadyStateTask, result: Result) -> Self:
        """Give what a task's result says, beside the bound of the law for its number of steps."""
        law = law_of(task.variant.preset)
        assert law is not None, "only variants with a law are compared with one"
        distance = result.series["distance"][0] if result.status is ResultStatus.FINISHED else math.nan
        gain = result.series.get("gain", (PERIODS_OF_ERROR,))[0]
        return cls(distance, law.bound_at(task.lane()[1]), gain=gain)


def with_predictions(
    findings: Iterable[Finding], predicted: Sequence[Finding], periods: Mapping[str, LawPeriod]
) -> list[Finding]:
    """Give the findings of a variant, its disagreements with what its law says of them in the same cases.

    A case without a period of its own takes the worst. What a scenario itself predicted of a finding, from what a
    preset states, stays. A law that is none of the chain says nothing, see `law_fault`.
    """
    fault = law_fault(predicted[0].variant) if predicted else None
    nothing = replace(predicted[0].comparison, verdict=Verdict.BLOCKED, reason=fault) if fault is not None else None
    laws = {
        (finding.case, finding.metric): finding if nothing is None else replace(finding, comparison=nothing)
        for finding in predicted
    }
    worst = max(periods.values(), key=_badness, default=LawPeriod(0.0, ROUND_OFF_PERIOD))
    largest = max((min(each.distance, each.bound) for each in periods.values() if each.distance >= 0), default=0.0)
    return [
        _with_prediction(finding, laws[finding.case, finding.metric], periods.get(finding.case, worst), largest)
        if needs_prediction(finding) and finding.prediction is None and (finding.case, finding.metric) in laws
        else finding
        for finding in findings
    ]


def _with_prediction(finding: Finding, own: Finding, period: LawPeriod, largest: float) -> Finding:
    """Give a finding with its prediction, or with the reason why the law does not represent the case."""
    if own.comparison.verdict is not Verdict.BLOCKED:
        prediction = _prediction(finding, own, period, largest)
        decides = finding.comparison.verdict is not Verdict.DISAGREE or not _leaves_open(finding, prediction)
        return replace(finding, prediction=prediction) if decides else _undecided(finding, prediction)
    reason = f"{finding.comparison.reason}; its law says nothing: {own.comparison.reason}"
    return replace(finding, comparison=replace(finding.comparison, reason=reason))


def _leaves_open(finding: Finding, prediction: Prediction) -> bool:
    """Whether a prediction holds, and would for no deviation at all."""
    return prediction.holds and prediction.allowed >= abs(finding.comparison.difference)


def _undecided(finding: Finding, prediction: Prediction) -> Finding:
    """Give a finding that deviates by less than what engine and law leave open."""
    reason = f"{finding.comparison.reason}; that is no more than what its law leaves open: {prediction}"
    return replace(finding, comparison=replace(finding.comparison, verdict=Verdict.INCONCLUSIVE, reason=reason))


def needs_prediction(finding: Finding) -> bool:
    """Whether a finding says that an engine deviates, or nothing: then its law is asked."""
    return finding.comparison.verdict in (Verdict.DISAGREE, Verdict.TOO_COARSE) or not finding.comparison.certified


def _badness(period: LawPeriod) -> float:
    """Give a number that is larger the less a period is as the law allows."""
    return math.inf if math.isnan(period.distance) else period.distance / period.bound


def _prediction(finding: Finding, own: Finding, period: LawPeriod, largest: float) -> Prediction:
    """Compare a number with that of the law, from which the engine is so far after a period.

    What distances add up to is taken from the `largest` of all cases that have one, as far as the law allows it: where
    a solver of the engine stops short, it does so in some periods and not in others. Where neither has a number, both
    for one reason, nothing is left.
    """
    certified = own.comparison.certified
    nothing = math.isnan(finding.value) and _same_gap(finding, own)
    left_open = finding.comparison.resolution + own.comparison.resolution + _added_up(period.gain * largest, finding)
    return Prediction(
        value=own.value,
        difference=0.0 if nothing else metric_difference(finding.metric, finding.value, own.value),
        allowed=0.0 if nothing else left_open,
        distance=period.distance,
        reason=period.reason,
        period_bound=period.bound,
        certified=certified,
    )


def _same_gap(finding: Finding, own: Finding) -> bool:
    """Whether engine and law both lack a certified steady state, or both disagree without a number."""
    gaps = [(each.comparison.certified, each.comparison.verdict) for each in (finding, own)]
    return math.isnan(own.value) and gaps[0] == gaps[1]


def _added_up(error: float, finding: Finding) -> float:
    """Give what is left of distances in a number, as amplitude; no less than round-off makes."""
    error = float(np.maximum(error, PERIODS_OF_ERROR * ROUND_OFF_PERIOD))
    if finding.metric.unit == "dB":
        return amplitude_in_db(error, finding.value)
    return error * finding.comparison.per_amplitude
