"""One point of a sweep: its results beside the reference's, what it is compared with, and how far from that it may be.

Presets that share the Euler scheme solve the reference's own equations: they are compared with the reference at equal
step, and nothing is allowed but what neither can resolve. All others, the reference itself among them, are compared
with the converged reference. They are simulated with half as many steps too, by their model where it `stands_in` for
them, so that their own error is known; the reference is simulated with twice and four times as many, and is judged by
them itself.

The transmittance is a complex number: its level and its phase are judged alike, and the worse of both decides.
"""

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import Protocol

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.engines.reference import CONVERGED_SUBSTEPS
from multibody_xval.engines.shared.law_distance import stepped_by, unclaimed_reason
from multibody_xval.scenarios.runs.result import Result, ResultStatus
from multibody_xval.scenarios.runs.task import SteadyStateTask
from multibody_xval.scenarios.sweeps.sweep import Case, GivenTolerance, GridPoint, Sweep, baseline, refinements
from multibody_xval.scenarios.verdicts.finding import (
    FLOOR_DB,
    PHASE,
    TRANSMITTANCE,
    Comparison,
    Finding,
    Metric,
    Prediction,
    Tolerance,
    Verdict,
)
from multibody_xval.scenarios.verdicts.judge import (
    FrictionEffect,
    Number,
    Read,
    Steps,
    certified,
    decide,
    friction_effect,
    missing,
    of_amplitude,
    of_response,
    response_readers,
)
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED, REFERENCE, amplification, is_resolved, resolution

UNBOUNDED: FrictionEffect = {TRANSMITTANCE: math.inf, PHASE: math.inf}
"""No step is too coarse for it."""

_SEVERITY = (Verdict.AGREE, Verdict.INCONCLUSIVE, Verdict.TOO_COARSE, Verdict.DISAGREE, Verdict.BLOCKED)


class GivesResults(Protocol):
    """What gives a result to every task: an evaluator, a store, a dataset."""

    def evaluate(self, tasks: Sequence[SteadyStateTask], /) -> list[Result]:
        """Give the results, in order; what is not known is ``missing``."""


@dataclass(frozen=True)
class Truth:
    """The true transmittance of a point."""

    transmittance_db: float = math.nan
    """20 log10 |U_n| / U0 [dB]; NaN where it is not known."""
    error_db: float = math.nan
    """Its own error bar [dB]."""
    exact: bool = False
    """Whether it is that of the exact motion, and not that of the converged reference."""
    proven: bool = False
    """Whether it is proven, see `multibody_xval.scenarios.verdicts.proven`."""

    @property
    def above_floor(self) -> bool:
        """Whether a difference from it in dB says something, see `FLOOR_DB`."""
        return self.transmittance_db > FLOOR_DB


@dataclass(frozen=True, kw_only=True)
class Point:
    """One variant at one point of the grid."""

    variant: Variant
    case: Case
    frequency_ratio: float
    result: Result
    others: tuple[Result, ...] = ()
    """Its results with other numbers of steps, see `refinements`."""
    modelled: bool = False
    """Whether these are those of its model."""
    reference: Result = field(default_factory=Result.missing)
    converged: Result = field(default_factory=Result.missing)
    """The reference's results at the same point, at equal step and converged."""
    refined: tuple[Result, ...] = ()
    """The reference's results at the same point with other numbers of steps."""
    given: GivenTolerance | None = None
    """The tolerance, where it is given; without it, it is derived."""
    effect: FrictionEffect = field(default_factory=lambda: UNBOUNDED)
    findings: tuple[Finding, ...] = ()
    """The comparisons of its transmittance and of its phase with those of its baseline; empty until it is judged."""
    truth: Truth = Truth()

    @property
    def place(self) -> GridPoint:
        """Variant, case and frequency ratio."""
        return self.variant, self.case, self.frequency_ratio

    @property
    def label(self) -> str:
        """Case and frequency ratio, as tables print them."""
        return f"{self.case}, η_r = {self.frequency_ratio:.6g}"

    @cached_property
    def expected(self) -> Result:
        """The result of its baseline."""
        return self.reference if baseline(self.variant, self.given) == REFERENCE else self.converged

    @property
    def is_known(self) -> bool:
        """Whether the result is certified, or repeats well enough to be compared all the same."""
        return _is_known(self.result, self.reference)

    @cached_property
    def left_open(self) -> float:
        """What the result leaves open of its amplitude, over the displacement scale."""
        return resolution(self.variant, self.result, self.result.transmittance_db, amplification(self.reference))

    @cached_property
    def finding(self) -> Finding:
        """The worst finding, which decides: by its verdict, then by its difference over what is allowed."""
        return max(self.findings, key=lambda own: (_SEVERITY.index(own.comparison.verdict), own.excess))

    @property
    def comparison(self) -> Comparison:
        """The comparison that decides."""
        return self.finding.comparison

    def difference(self, metric: Metric) -> float:
        """Give the difference from the baseline in the unit of a metric; NaN where it was not compared."""
        return next((own.comparison.difference for own in self.findings if own.metric == metric), math.nan)

    def allowed(self, metric: Metric) -> float:
        """Give the largest such difference that counts as agreement; likewise."""
        return next((own.comparison.tolerance for own in self.findings if own.metric == metric), math.nan)

    def prediction(self, *metrics: Metric) -> Prediction | None:
        """Give what the law of the variant says of the first of these metrics that it was asked about."""
        predictions = (own.prediction for own in self.findings if own.metric in metrics)
        return next((one for one in predictions if one is not None), None)


def _is_known(result: Result, reference: Result) -> bool:
    return result.converged or is_resolved(result, amplification(reference))


def tasks_of(sweep: Sweep, places: Sequence[GridPoint]) -> list[SteadyStateTask]:
    """Give the tasks of all places that are known from the start: one each, then the reference's with other steps.

    Those of other variants depend on their results: none where there is nothing to compare, and perhaps their model's.
    """
    further = [task for place in places if place[0] == REFERENCE for task in other_tasks(sweep, place)]
    return [*(sweep.task(*place) for place in places), *further]


def other_tasks(sweep: Sweep, place: GridPoint, by: Variant | None = None) -> list[SteadyStateTask]:
    """Give the tasks of a place with other numbers of steps, of its variant or `by` its model."""
    variant, case, eta = place
    return [sweep.task(by or variant, case, eta, factor) for factor in refinements(variant, sweep.tolerance)]


def stands_in(sweep: Sweep, place: GridPoint, result: Result) -> bool:
    """Whether the model of a variant may give its results with other numbers of steps.

    It may where it claims to predict them, and its steady state has just been shown to be the engine's: the engine's
    search begins there, and has ended after one plain period.
    """
    if not result.converged or result.periods != 1 or place[0].law is None:
        return False
    law, others = stepped_by(place[0]), other_tasks(sweep, place)
    if law is None or not others:
        return False
    return all(unclaimed_reason(law, task.lane()[0]) is None for task in (sweep.task(*place), *others))


def evaluated(
    sweep: Sweep, places: Sequence[GridPoint], evaluator: GivesResults, modelled: Collection[Variant] = ()
) -> list[Point]:
    """Evaluate all places at once, and give them beside the reference's results at the same place.

    Of `modelled` variants, the model gives the results with other numbers of steps where it `stands_in`. Points that
    have ended with nothing to compare have none, but for the reference's, by which others are judged.
    """
    first = dict(zip(places, evaluator.evaluate([sweep.task(*place) for place in places]), strict=True))
    tasks = {place: _further_tasks(sweep, place, first, modelled) for place in first}
    results = iter(evaluator.evaluate([task for own in tasks.values() for task in own]))
    known = {place: (first[place], tuple(next(results) for _ in own)) for place, own in tasks.items()}
    unknown: tuple[Result, tuple[Result, ...]] = (Result.missing(), ())
    points = []
    for (variant, case, eta), (result, own) in known.items():
        reference, refined = known.get((REFERENCE, case, eta), unknown)
        converged, _ = known.get((CONVERGED, case, eta), unknown)
        effect = _effect(sweep.task(REFERENCE, case, eta), converged.transmittance_db, converged.phase)
        points.append(
            Point(
                variant=variant, case=case, frequency_ratio=eta, result=result, others=own,
                modelled=any(task.variant != variant for task in tasks[variant, case, eta]), reference=reference,
                converged=converged, refined=refined, given=sweep.tolerance, effect=effect,
            )
        )  # fmt: skip
    return points


def _further_tasks(
    sweep: Sweep, place: GridPoint, first: Mapping[GridPoint, Result], modelled: Collection[Variant]
) -> list[SteadyStateTask]:
    """Give the tasks of a place with other numbers of steps, by the results with the usual one."""
    result, reference = first[place], first.get((REFERENCE, *place[1:]), Result.missing())
    has_ended = place[0] != REFERENCE and result.status is not ResultStatus.MISSING
    if has_ended and not _is_known(result, reference):
        return []
    model = place[0].law if place[0] in modelled and stands_in(sweep, place, result) else None
    return other_tasks(sweep, place, model)


@lru_cache(maxsize=10_000)
def _effect(task: SteadyStateTask, transmittance_db: float, phase: float) -> FrictionEffect:
    """Give how much friction changes a point at all; without limit where its steady state is not known."""
    if math.isnan(transmittance_db) or math.isnan(phase):
        return UNBOUNDED
    return friction_effect(*task.setting(), transmittance_db, phase)


def judged(points: Iterable[Point]) -> list[Point]:
    """Compare every point with its baseline."""
    return [replace(point, findings=point_findings(point)) for point in points]


def point_findings(point: Point) -> tuple[Finding, ...]:
    """Compare transmittance and phase with those of the baseline; no phase where none is expected."""
    readers = response_readers(point.expected.transmittance_db, point.expected.phase)
    gap = (None if point.is_known else missing("engine", [point.result])) or missing("reference", [point.expected])
    if gap is not None:
        return tuple(Finding.without_numbers(point.variant, point.label, readers, gap))
    certain = certified([point.result])
    return tuple(
        Finding(
            point.variant, point.label, metric, read(point.result), read(point.expected),
            replace(_compared(point, metric, read, point.result, point.expected), certified=certain),
        )
        for metric, read in readers.items()
    )  # fmt: skip


def verdict_of(point: Point, result: Result, expected: Result) -> Verdict:
    """Give the verdict on a point if this were its result, and that its baseline's, by the tolerance that it has."""
    readers = response_readers(expected.transmittance_db, expected.phase)
    verdicts = (_compared(point, metric, read, result, expected).verdict for metric, read in readers.items())
    return max(verdicts, key=_SEVERITY.index)


def _compared(point: Point, metric: Metric, read: Read, result: Result, expected: Result) -> Comparison:
    """Compare one number of a result of a point with what is expected."""
    comparison = decide(metric, read(result), read(expected), tolerance(point, metric, read), point.effect[metric])
    comparison = of_response(unless_own_error_is_unknown(point, comparison), metric, expected.transmittance_db)
    return comparison if metric == TRANSMITTANCE else replace(comparison, reason=f"{metric.name}: {comparison.reason}")


def _level(result: Result) -> float:
    return result.transmittance_db


def unless_own_error_is_unknown(point: Point, comparison: Comparison) -> Comparison:
    """Leave a disagreement open where the variant's own error is unknown: no steady state with other steps."""
    if comparison.verdict is not Verdict.DISAGREE or all(other.converged for other in point.others):
        return comparison
    reason = f"{comparison.reason}; no steady state with other steps gives its own error"
    return replace(comparison, verdict=Verdict.INCONCLUSIVE, reason=reason)


def tolerance(point: Point, metric: Metric = TRANSMITTANCE, read: Read = _level) -> Tolerance:
    """Derive how far a number of a point may be from that of its baseline, in the unit of the metric."""
    if point.given is not None and point.given.judges(point.variant):
        return Tolerance(given=_given(point.given.transmittance_db, metric))
    left_open = point_resolution(point, metric, point.expected)
    if baseline(point.variant) == REFERENCE:
        return Tolerance(resolution=left_open)
    scheme = scheme_by_steps(point, read)
    finest = max(scheme)
    own = {point.result.steps_per_period: read(point.result)} | _by_steps(read, *point.others)
    at = point.reference.steps_per_period if point.reference.converged else finest
    return Tolerance(
        reference=Steps(scheme, finest).error(metric),
        engine=Steps(own, point.result.steps_per_period).error(metric),
        resolution=left_open,
        # the reference itself is judged by its own steps alone: its error cannot excuse itself
        scheme=0.0 if point.variant == REFERENCE else Steps(scheme, at).error(metric),
    )


def scheme_by_steps(point: Point, read: Read = _level) -> dict[int, Number]:
    """Read a number of the reference's results by steps a period; that of the converged reference is the finest."""
    scheme = _by_steps(read, point.reference, *point.refined)
    if point.converged.converged:
        scheme[point.converged.steps_per_period * CONVERGED_SUBSTEPS] = read(point.converged)
    return scheme


def point_resolution(point: Point, metric: Metric, expected: Result) -> float:
    """Give what the result leaves open of a number, in the unit of the metric, near an expected result."""
    return of_amplitude(metric, point.left_open, max(expected.transmittance_db, FLOOR_DB))


def _given(transmittance_db: float, metric: Metric) -> float:
    """Give a tolerance of the transmittance for a metric: a change of amplitude of that size, in any direction."""
    if metric == TRANSMITTANCE:
        return transmittance_db
    return min(180.0, math.degrees(10 ** (transmittance_db / 20) - 1))


def own_error_db(point: Point) -> float:
    """Estimate the error of a point from its own steps [dB]; NaN where it is known with one number of steps only."""
    own = _by_steps(_level, point.result, *point.others)
    if not point.result.converged or len(own) < 2:
        return math.nan
    return Steps(own, point.result.steps_per_period).error(TRANSMITTANCE)


def _by_steps(read: Read, *results: Result) -> dict[int, Number]:
    """Read a number of those that have a steady state, by steps a period."""
    return {result.steps_per_period: read(result) for result in results if result.converged}
