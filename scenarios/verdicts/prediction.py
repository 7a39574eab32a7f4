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

from engines.interface.law import ROUND_OFF_PERIOD
from engines.interface.registry import law_of
from reference_lcp.steady.richardson import amplitude_in_db
from scenarios.runs.result import Result, ResultStatus
from scenarios.runs.task import SteadyStateTask
from scenarios.verdicts.finding import Finding, Prediction, Verdict
from scenarios.verdicts.judge import metric_difference

PERIODS_OF_ERROR = 400
"""Periods whose differences between engine and law add up at most: motions never drift apart, the longest of the
catalogue have 320 periods, and a steady state is searched for in as many."""


@dataclass(frozen=True)
class LawPeriod:
    """How far an engine is from its law after a period from the same state, over the displacement scale."""

    distance: float
    """Largest difference of positions; NaN, which no bound allows, where there is none."""
    bound: float
    reason: str = ""
    """Why there is no distance, or one that is larger than the bound, where that is known; empty elsewhere."""

    @classmethod
    def of(cls, task: SteadyStateTask, result: Result) -> Self:
        """Give what a task's result says, beside the bound of the law for its number of steps."""
        law = law_of(task.variant.preset)
        assert law is not None, "only variants with a law are compared with one"
        distance = result.series["distance"][0] if result.status is ResultStatus.FINISHED else math.nan
        return cls(distance, law.bound_at(task.lane()[1]))


def with_predictions(
    findings: Iterable[Finding], predicted: Sequence[Finding], periods: Mapping[str, LawPeriod]
) -> list[Finding]:
    """Give the findings of a variant, its disagreements with what its law says of them in the same cases.

    A case without a period of its own takes the worst. What a scenario itself predicted of a finding, from what a
    preset states, stays.
    """
    laws = {(finding.case, finding.metric): finding for finding in predicted}
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
        return replace(finding, prediction=_prediction(finding, own, period, largest))
    reason = f"{finding.comparison.reason}; its law says nothing: {own.comparison.reason}"
    return replace(finding, comparison=replace(finding.comparison, reason=reason))


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
    left_open = finding.comparison.resolution + own.comparison.resolution + _added_up(largest, finding)
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


def _added_up(distance: float, finding: Finding) -> float:
    """Give what distances of a period make of a number while they add up; no less than round-off makes."""
    error = PERIODS_OF_ERROR * float(np.maximum(distance, ROUND_OFF_PERIOD))
    if finding.metric.unit == "dB":
        return amplitude_in_db(error, finding.value)
    return error * finding.comparison.per_amplitude
