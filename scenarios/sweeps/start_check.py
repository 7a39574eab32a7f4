"""Whether steady states depend on where their search began: a sample of points, searched from harmonic balance too.

The search for an engine's steady state begins at that of its law, or beside the reference's, see
`scenarios.runs.steady`. Friction under a given normal force has one steady state; an engine whose
step is not monotone may have several, and the search would find the one that the model predicts. A sample of every
variant is therefore searched from harmonic balance as well. Where one point of it ends elsewhere, all points of the
variant that have a steady state are searched both ways, and those that differ are inconclusive.
"""

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from engines.interface.variant import Variant
from scenarios.runs.result import Result, ResultStatus
from scenarios.runs.steady import is_warm_started
from scenarios.runs.task import Start
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.point import GivesResults, Point
from scenarios.sweeps.sweep import GridPoint, Sweep
from scenarios.verdicts.finding import Comparison, Verdict

SHARE = 0.05
"""Part of a variant's points that are searched both ways."""

LEAST_POINTS = 20
"""Fewest of them: a second steady state at one point in ten is missed by 20 points once in eight reports."""


@dataclass(frozen=True)
class StartCheck:
    """What became of the points of one variant that were searched from harmonic balance too."""

    variant: Variant
    searched: int
    """Points that were searched both ways, and whose both searches ended in a steady state."""
    elsewhere: int


def check_starts(
    result: ComparedSweep, evaluator: GivesResults, least: int = LEAST_POINTS
) -> tuple[ComparedSweep, tuple[StartCheck, ...]]:
    """Search a sample of every variant from harmonic balance too, `least` points of each or all that it has.

    Gives the sweep with points that have two steady states inconclusive, and a check of each variant but the suite's
    models.
    """
    steady = {
        variant: [point for point in result.points_of(variant) if point.result.converged]
        for variant in result.sweep.variants
        if is_warm_started(variant)
    }
    samples = [point for own in steady.values() for point in _sample(result.sweep, own, least)]
    differing = _differing(result.sweep, samples, evaluator)
    doubtful = {variant for (variant, _, _), apart in differing.items() if apart}
    rest = [point for variant in doubtful for point in steady[variant] if point.place not in differing]
    differing |= _differing(result.sweep, rest, evaluator)
    checks = []
    for variant in steady:
        ends = [apart for (owner, _, _), apart in differing.items() if owner == variant and apart is not None]
        checks.append(StartCheck(variant, len(ends), sum(map(bool, ends))))
    points = [_inconclusive(point, differing.get(point.place)) for point in result.points]
    return replace(result, points=points), tuple(checks)


def _sample(sweep: Sweep, steady: Sequence[Point], least: int) -> list[Point]:
    """Choose points of a variant by the hashes of their tasks: at random, and always alike."""
    count = max(least, math.ceil(SHARE * len(steady)))
    return sorted(steady, key=lambda point: sweep.task(*point.place).key())[:count]


def _differing(sweep: Sweep, points: Sequence[Point], evaluator: GivesResults) -> dict[GridPoint, str | None]:
    """Say of points how the steady state from harmonic balance differs; empty where not, ``None`` without any."""
    tasks = [replace(sweep.task(*point.place), start=Start.HARMONIC_BALANCE) for point in points]
    pairs = zip(points, evaluator.evaluate(tasks), strict=True)
    return {point.place: _difference(point, balanced) for point, balanced in pairs}


def _difference(point: Point, balanced: Result) -> str | None:
    """Compare two certified motions of one engine: both may be off by what they leave open."""
    if balanced.status is not ResultStatus.CONVERGED or not point.result.converged:
        return None
    apart = abs(_complex(point.result) - _complex(balanced))
    if apart <= point.left_open + replace(point, result=balanced).left_open:
        return ""
    return f"another steady state, of {balanced.transmittance_db:.4g} dB, from harmonic balance"


def _complex(result: Result) -> complex:
    return cmath.rect(10 ** (result.transmittance_db / 20), result.phase)


def _inconclusive(point: Point, reason: str | None) -> Point:
    """Give a point that has two steady states, for this reason, no verdict."""
    if not reason:
        return point
    comparison = Comparison(Verdict.INCONCLUSIVE, reason, certified=False)
    findings = (replace(finding, comparison=comparison, prediction=None) for finding in point.findings)
    return replace(point, findings=tuple(findings))
