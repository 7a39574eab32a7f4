"""How the points of a sweep ended: statuses, reasons, and the periods that steady states took."""

from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from engines.interface.variant import Variant
from scenarios.tasks.result import ResultStatus, ResultSummary, repetition


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

    def add(self, variant: Variant, outcome: ResultSummary) -> None:
        """Count a point."""
        self.statuses[variant, outcome.status] += 1
        if outcome.status == ResultStatus.CONVERGED:
            self.periods[variant, outcome.periods] += 1
        else:
            self.reasons[variant, reason_of(outcome)] += 1

    def quantile_of_periods(self, variant: Variant, part: float) -> int | None:
        """Give the fewest periods that suffice for this part of the points with a steady state; ``None`` without."""
        counts = sorted((periods, count) for (who, periods), count in self.periods.items() if who == variant)
        if not counts:
            return None
        reached = np.cumsum([count for _, count in counts])
        return counts[int(np.searchsorted(reached, part * reached[-1]))][0]


def reason_of(outcome: ResultSummary) -> str:
    """Say in words why a point has no steady state."""
    if outcome.status == ResultStatus.PERIOD_LIMIT:
        return f"period limit{repetition(outcome.multiple)}"
    return outcome.reason or outcome.status
