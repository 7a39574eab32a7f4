"""Whether steady states depend on where their search began: a sample of points, searched from harmonic balance too.

The search for an engine's steady state begins at that of its law, or beside the reference's, see
`scenarios.runs.steady`. Friction under a given normal force has one steady state; an engine whose
step is not monotone may have several, and the search would find the one that the model predicts. A sample of every
variant is therefore searched from harmonic balance as well. Where one point of it ends elsewhere, all points of the
variant that have a steady state are searched both ways, and those that differ are undecided.
"""

import cmath
import math
from collections import defaultdict
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from engines.interface.variant import Variant
from scenarios.runs.result import Result, ResultStatus
from scenarios.runs.steady import begins_beside
from scenarios.runs.task import Start
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.table import GivesResults, Point, with_columns
from scenarios.verdicts.finding import Comparison, Finding, Verdict
from scenarios.verdicts.pointwise import PointResults, amplitude_left_open

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

    Gives the sweep with points that have two steady states undecided, and a check of each variant but the suite's
    models.
    """
    samples = {variant: _sample(result, variant, least) for variant in result.sweep.variants if begins_beside(variant)}
    differing = _differing(result, [row for sample in samples.values() for row in sample], evaluator)
    doubtful = {result.points[row].variant for row, apart in differing.items() if apart}
    rest = [row for row in _steady_rows(result, doubtful) if row not in differing]
    differing |= _differing(result, rest, evaluator)
    checks = defaultdict(list)
    for row, apart in differing.items():
        if apart is not None:
            checks[result.points[row].variant].append(bool(apart))
    return _undecided(result, differing), tuple(
        StartCheck(variant, len(checks[variant]), sum(checks[variant])) for variant in samples
    )


def _steady_rows(result: ComparedSweep, variants: Collection[Variant]) -> list[int]:
    """Give the rows of variants that have a steady state."""
    return [row for row, point in enumerate(result.points) if point.variant in variants and point.result.converged]


def _sample(result: ComparedSweep, variant: Variant, least: int) -> list[int]:
    """Choose rows of a variant that have a steady state, by the hashes of their tasks: at random, and always alike."""
    rows = _steady_rows(result, {variant})
    count = max(least, math.ceil(SHARE * len(rows)))
    return sorted(rows, key=lambda row: result.sweep.task(*result.points[row][:3]).key())[:count]


def _differing(result: ComparedSweep, rows: Sequence[int], evaluator: GivesResults) -> dict[int, str | None]:
    """Say of rows how the steady state from harmonic balance differs; empty where not, ``None`` where there is none."""
    points = [result.points[row] for row in rows]
    tasks = [replace(result.sweep.task(*point[:3]), start=Start.HARMONIC_BALANCE) for point in points]
    known = result.results
    return {
        row: _difference(known[point[:3]], balanced)
        for row, point, balanced in zip(rows, points, evaluator.evaluate(tasks), strict=True)
    }


def _difference(known: PointResults, balanced: Result) -> str | None:
    """Compare two certified motions of one engine: both may be off by what they leave open."""
    if balanced.status is not ResultStatus.CONVERGED or not known.result.converged:
        return None
    apart = abs(_complex(known.result) - _complex(balanced))
    if apart <= amplitude_left_open(known) + amplitude_left_open(replace(known, result=balanced)):
        return ""
    return f"another steady state, of {balanced.transmittance_db:.4g} dB, from harmonic balance"


def _complex(result: Result) -> complex:
    return cmath.rect(10 ** (result.transmittance_db / 20), result.phase)


def _undecided(result: ComparedSweep, differing: dict[int, str | None]) -> ComparedSweep:
    """Give points that have two steady states no verdict."""
    findings = [
        _without_verdict(point, reason) if (reason := differing.get(row)) else point.findings
        for row, point in enumerate(result.points)
    ]
    return replace(result, table=with_columns(result.table, findings=findings))


def _without_verdict(point: Point, reason: str) -> tuple[Finding, ...]:
    comparison = Comparison(Verdict.INCONCLUSIVE, reason, certified=False)
    return tuple(replace(finding, comparison=comparison, prediction=None) for finding in point.findings)
