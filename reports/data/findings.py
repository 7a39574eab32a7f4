"""What each variant of a compared sweep comes to, in one row of numbers."""

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from statistics import median

from engines.interface.variant import Variant
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.sweep import Case
from scenarios.tasks.result import ResultStatus
from scenarios.verdicts.verdict import Verdict


@dataclass(frozen=True)
class Extreme:
    """The largest difference of its kind, with its sign and its point; NaN where nothing was compared."""

    difference: float = math.nan
    case: Case | None = None
    frequency_ratio: float = math.nan


@dataclass(frozen=True)
class VariantFindings:
    """One variant in one row.

    Parameters
    ----------
    variant
        Which.
    verdicts
        Points of the grid by verdict.
    worst_edge
        Of the band edges, from those of what the variant is compared with.
    worst_residual
        Largest periodicity residual of the points that converged.
    median_periods
        Periods simulated until a point converged, the median.
    seconds
        Time of all points of the grid together, on one core, with those that did not converge; refinement of
        edges not counted.
    blocked
        Why it has no result at all; ``None`` if it has one.
    """

    variant: Variant
    verdicts: dict[str, int]
    worst_edge: Extreme
    worst_residual: float
    median_periods: float
    seconds: float
    blocked: str | None


def findings(result: ComparedSweep, variant: Variant) -> VariantFindings:
    """Sum up all points and edges of a variant."""
    points = result.points_of(variant)
    converged = [point.result for point in points if point.result.converged]
    seconds = [point.result.seconds for point in points if not math.isnan(point.result.seconds)]
    counted = Counter(str(point.comparison.verdict) for point in points)
    return VariantFindings(
        variant=variant,
        verdicts={str(verdict): counted[str(verdict)] for verdict in Verdict},
        worst_edge=worst(_of_edges(result, variant)),
        worst_residual=max((result.residual for result in converged), default=math.nan),
        median_periods=float(median([result.periods for result in converged])) if converged else math.nan,
        seconds=sum(seconds) if seconds else math.nan,
        blocked=blocked_reason(result, variant),
    )


def blocked_reason(result: ComparedSweep, variant: Variant) -> str | None:
    """Give the reason why a variant has no result at all; ``None`` if it has one."""
    results = [point.result for point in result.points_of(variant)]
    if not results or any(own.status is not ResultStatus.BLOCKED for own in results):
        return None
    return results[0].reason


def _of_edges(result: ComparedSweep, variant: Variant) -> list[Extreme]:
    return [
        Extreme(edge.comparison.difference, edge.case, edge.frequency_ratio)
        for edge in result.edges
        if edge.variant == variant and edge.frequency_ratio is not None
    ]


def worst(extremes: Iterable[Extreme]) -> Extreme:
    """Give the largest of those that are known."""
    known = [extreme for extreme in extremes if not math.isnan(extreme.difference)]
    return max(known, key=lambda extreme: abs(extreme.difference), default=Extreme())
