"""Samples of a sweep's points that are computed the long way too, so that no shortcut goes unnoticed that misses.

*Starts.* The search for an engine's steady state begins at that of its law, or beside the reference's, see
`multibody_xval.scenarios.runs.steady`. Friction under a given normal force has one steady state; an engine whose
step is not monotone may have several, and the search would find the one that the model predicts. A sample of every
variant is therefore searched from harmonic balance as well. Where one point of it ends in a steady state that has
another verdict, or is farther away than its tolerance, all points of the variant that have a steady state are searched
both ways, and those that differ so are inconclusive.

*Models.* With other numbers of steps, the model of a variant stands in for its engine where both have just been shown
equal, see `multibody_xval.scenarios.sweeps.point.stands_in`. A sample of these points is run by the engine with other
numbers of steps as well. Where one of them differs, or none can be compared, the engine gives all points of the
variant.
"""

import cmath
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.result import Result, ResultStatus
from multibody_xval.scenarios.runs.steady import is_warm_started
from multibody_xval.scenarios.runs.task import Start, unsourced_key
from multibody_xval.scenarios.sweeps.point import GivesResults, Point, evaluated, other_tasks, verdict_of
from multibody_xval.scenarios.sweeps.sweep import GridPoint, Sweep
from multibody_xval.scenarios.verdicts.finding import Comparison, Verdict

SHARE = 0.05
"""Part of a variant's points that are computed both ways."""

LEAST_POINTS = 20
"""Fewest of them: a second steady state at one point in ten is missed by 20 points once in eight reports."""


@dataclass(frozen=True)
class Check:
    """What became of the points of one variant that were computed the long way too."""

    variant: Variant
    compared: int
    """Points that could be compared."""
    differing: int

    @property
    def passed(self) -> bool:
        """Whether points were compared, and none differs."""
        return self.differing == 0 < self.compared


def check_models(
    sweep: Sweep, places: Sequence[GridPoint], evaluator: GivesResults, least: int = LEAST_POINTS
) -> tuple[list[Point], tuple[Check, ...]]:
    """Evaluate places as `evaluated` does, models standing in for the engines of variants whose sample does not differ.

    The sample is of `least` points of each variant or all that it has, and every variant that a model stands in for has
    a check.
    """
    points = evaluated(sweep, places, evaluator, sweep.variants)
    modelled = {
        variant: own
        for variant in sweep.variants
        if (own := [point for point in points if point.variant == variant and point.modelled])
    }
    _, checks = _both_ways(sweep, modelled, lambda sample: _by_engines(sweep, sample, evaluator), least)
    if not all(check.passed for check in checks):
        points = evaluated(sweep, places, evaluator, passed(checks))
    return points, checks


def passed(checks: Sequence[Check]) -> list[Variant]:
    """Give the variants whose check has passed."""
    return [check.variant for check in checks if check.passed]


def _by_engines(sweep: Sweep, points: Sequence[Point], evaluator: GivesResults) -> dict[GridPoint, str | None]:
    """Say of points how their engines differ from what stands in for them; empty where not, ``None`` without any."""
    tasks = [task for point in points for task in other_tasks(sweep, point.place)]
    results = iter(evaluator.evaluate(tasks))
    differing = {}
    for point in points:
        known = [_steps_difference(point, modelled, next(results)) for modelled in point.others]
        differing[point.place] = next(filter(None, known), None if None in known else "")
    return differing


def _steps_difference(point: Point, modelled: Result, own: Result) -> str | None:
    """Compare a result of a model with the engine's own: also whether there is a steady state at all."""
    if ResultStatus.MISSING in (modelled.status, own.status) or not (modelled.converged or own.converged):
        return None
    if modelled.converged and own.converged and not _are_apart(replace(point, result=own), modelled):
        return ""
    return f"another result with {modelled.steps_per_period} steps a period"


def check_starts(
    sweep: Sweep, points: Sequence[Point], evaluator: GivesResults, least: int = LEAST_POINTS
) -> tuple[list[Point], tuple[Check, ...]]:
    """Search a sample of every variant from harmonic balance too, `least` points of each or all that it has.

    Gives the points, those that have two steady states apart inconclusive, and a check of each variant but the suite's
    models.
    """
    steady = {
        variant: [point for point in points if point.variant == variant and point.result.converged]
        for variant in sweep.variants
        if is_warm_started(variant)
    }
    differing, checks = _both_ways(sweep, steady, lambda sample: _from_balance(sweep, sample, evaluator), least)
    return [_inconclusive(point, differing.get(point.place)) for point in points], checks


def _from_balance(sweep: Sweep, points: Sequence[Point], evaluator: GivesResults) -> dict[GridPoint, str | None]:
    """Say of points how the steady state from harmonic balance differs; empty where not, ``None`` without any."""
    tasks = [replace(sweep.task(*point.place), start=Start.HARMONIC_BALANCE) for point in points]
    pairs = zip(points, evaluator.evaluate(tasks), strict=True)
    return {point.place: _difference(point, balanced) for point, balanced in pairs}


def _difference(point: Point, balanced: Result) -> str | None:
    """Compare two steady states of one engine: what counts are two verdicts, or a distance that is not allowed."""
    if not balanced.converged or not point.result.converged:
        return None
    if not _are_apart(point, balanced):
        return ""
    one_verdict = verdict_of(point, balanced, point.expected) is point.comparison.verdict
    if one_verdict and verdict_of(point, balanced, point.result) is not Verdict.DISAGREE:
        return ""
    return f"another steady state, of {balanced.transmittance_db:.4g} dB, from harmonic balance"


def _both_ways(
    sweep: Sweep,
    points: Mapping[Variant, Sequence[Point]],
    compared: Callable[[Sequence[Point]], dict[GridPoint, str | None]],
    least: int,
) -> tuple[dict[GridPoint, str | None], tuple[Check, ...]]:
    """Compare a sample of every variant's points, and all points of those of whose sample one differs."""
    differing = compared([point for own in points.values() for point in _sample(sweep, own, least)])
    doubtful = {variant for (variant, _, _), apart in differing.items() if apart}
    differing |= compared([point for variant in doubtful for point in points[variant] if point.place not in differing])
    checks = []
    for variant in points:
        ends = [apart for (owner, _, _), apart in differing.items() if owner == variant and apart is not None]
        checks.append(Check(variant, len(ends), sum(map(bool, ends))))
    return differing, tuple(checks)


def _sample(sweep: Sweep, points: Sequence[Point], least: int) -> list[Point]:
    """Choose points of a variant by the hashes of their tasks: at random, and alike until its engine changes."""
    count = max(least, math.ceil(SHARE * len(points)))
    return sorted(points, key=lambda point: unsourced_key(sweep.task(*point.place).text()))[:count]


def _are_apart(point: Point, other: Result) -> bool:
    """Whether two certified motions differ: both may be off by what they leave open."""
    apart = abs(_complex(point.result) - _complex(other))
    return apart > point.left_open + replace(point, result=other).left_open


def _complex(result: Result) -> complex:
    return cmath.rect(10 ** (result.transmittance_db / 20), result.phase)


def _inconclusive(point: Point, reason: str | None) -> Point:
    """Give a point that has two steady states, for this reason, no verdict."""
    if not reason:
        return point
    comparison = Comparison(Verdict.INCONCLUSIVE, reason, certified=False)
    findings = (replace(finding, comparison=comparison, prediction=None) for finding in point.findings)
    return replace(point, findings=tuple(findings))
