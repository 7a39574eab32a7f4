"""How the points of a sweep ended: statuses, reasons, periods that steady states took, verdicts."""

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from engines.interface.variant import Variant
from scenarios.sweeps.sweep import Sweep, baseline_of
from scenarios.sweeps.table import Point
from scenarios.tasks.result import ResultStatus, ResultSummary, repetition
from scenarios.verdicts.finding import TRANSMITTANCE
from scenarios.verdicts.verdict import Verdict


@dataclass
class SweepSummary:
    """Counts over all points; the points themselves are in the store.

    Parameters
    ----------
    statuses
        Points by variant and status.
    reasons
        Points without a steady state by variant and reason.
    periods
        Points with a steady state by variant and number of periods.
    unresolved
        Curves of an adaptive grid, by variant, that ended at its least spacing or at its most points.
    """

    statuses: Counter[tuple[Variant, ResultStatus]] = field(default_factory=Counter)
    reasons: Counter[tuple[Variant, str]] = field(default_factory=Counter)
    periods: Counter[tuple[Variant, int]] = field(default_factory=Counter)
    unresolved: Counter[Variant] = field(default_factory=Counter)

    def add(self, variant: Variant, ended: ResultSummary) -> None:
        """Count a point."""
        self.statuses[variant, ended.status] += 1
        if ended.status == ResultStatus.CONVERGED:
            self.periods[variant, ended.periods] += 1
        else:
            self.reasons[variant, reason_of(ended)] += 1

    def quantile_of_periods(self, variant: Variant, part: float) -> int | None:
        """Give the fewest periods that suffice for this part of the points with a steady state; ``None`` without."""
        counts = sorted((periods, count) for (owner, periods), count in self.periods.items() if owner == variant)
        if not counts:
            return None
        reached = np.cumsum([count for _, count in counts])
        return counts[int(np.searchsorted(reached, part * reached[-1]))][0]


def reason_of(ended: ResultSummary) -> str:
    """Give the reason why a point has no steady state, in words."""
    if ended.status == ResultStatus.PERIOD_LIMIT:
        return f"period limit{repetition(ended.multiple)}"
    return ended.reason or ended.status


@dataclass
class VerdictSummary:
    """The verdicts of one variant, counted.

    Parameters
    ----------
    counts
        Points by verdict; those that are not evaluated, of the variant or of its baseline, are not among them.
    largest
        Point of the largest difference [dB] where both have a steady state; ``None`` without any.
    """

    counts: Counter[Verdict] = field(default_factory=Counter)
    largest: Point | None = None

    def add(self, point: Point) -> None:
        """Count a point."""
        self.counts[point.comparison.verdict] += 1
        size = abs(point.difference(TRANSMITTANCE))
        if not math.isnan(size) and (self.largest is None or size > abs(self.largest.difference(TRANSMITTANCE))):
            self.largest = point


def verdict_summaries(sweep: Sweep, points: Iterable[Point]) -> dict[Variant, VerdictSummary]:
    """Sum up the judged points of every variant but the baseline, where both are evaluated."""
    baseline = baseline_of(sweep.variants)
    if baseline is None:
        return {}
    every = list(points)
    evaluated = {point[:3] for point in every if point.result.status is not ResultStatus.MISSING}
    summaries = {variant: VerdictSummary() for variant in sweep.variants if variant != baseline}
    for point in every:
        if point.variant != baseline and {point[:3], (baseline, *point[1:3])} <= evaluated:
            summaries[point.variant].add(point)
    return summaries
