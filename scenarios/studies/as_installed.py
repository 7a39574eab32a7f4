"""Variants at a few points of a compared sweep, beside those of its whole grid: what an engine does as installed.

They have no verdict: they are compared with the truth alone, and decide about nothing.
"""

import math
from collections.abc import Sequence

from engines.interface.variant import Variant
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.sweep import Case
from scenarios.sweeps.table import GivesResults, Point
from scenarios.tasks.parameters import OperatingPoint
from scenarios.tasks.result import ResultStatus

FEW_POINTS = (*(OperatingPoint(0.1, eta) for eta in (0.6, 1.1, 1.4, 1.6)), OperatingPoint(1.0, 0.6))
"""Within the band and on both its flanks with little friction, where engines differ most, and with much friction. They
are few since presets that never settle take seconds a point."""

QUICK_POINTS = (OperatingPoint(0.3, 0.9), OperatingPoint(0.3, 1.6))
"""Likewise, of the grid of a preview."""


def few_points(
    result: ComparedSweep, variants: Sequence[Variant], points: Sequence[OperatingPoint], evaluator: GivesResults
) -> tuple[Point, ...]:
    """Evaluate variants at those of the points that the grid of the sweep holds; without those that have no result."""
    places = [place for point in points if (place := _place(result, point)) is not None]
    every = [(variant, *place) for variant in variants for place in places]
    results = evaluator.evaluate([result.sweep.task(*point) for point in every])
    known = zip(every, results, strict=True)
    return tuple(Point(*point, own, (), ()) for point, own in known if own.status != ResultStatus.MISSING)


def _place(result: ComparedSweep, point: OperatingPoint) -> tuple[Case, float] | None:
    """Give case and frequency ratio of a point of the grid, where they are there to round-off."""
    for case in result.cases:
        for eta in result.sweep.frequency_ratios:
            if case.friction_ratio == point.friction_ratio and math.isclose(eta, point.frequency_ratio):
                return case, eta
    return None
