"""Stick and slip: transitions and stuck fractions at a few points, against the reference at equal time step."""

from functools import cached_property
from typing import Any

from engines.interface.variant import Variant
from reference_lcp.observables.transition_matching import MATCHING_WINDOW
from reports.data.descriptions import axis_name
from reports.data.stick_slip import CasePoint, compared_points, point_at
from reports.drawing.figure import Figure
from reports.figures.hysteresis import hysteresis
from reports.figures.stick_slip import raster
from reports.formatting import ratio
from reports.page.section import Section
from scenarios.tasks.result import Result
from scenarios.verdicts.pointwise import CONVERGED
from scenarios.verdicts.steady_case import REFERENCE

MOST_RASTERS = 12
"""Most points that are drawn; a sweep over more than friction holds each of them many times."""


class StickSlip(Section):
    """Modes over one period, hysteresis loops, and the rows of `reports.data.stick_slip.stick_slip_rows`."""

    title = "Stick and slip"
    template = "stick_slip"
    numbers = "transitions.csv"

    @property
    def shown(self) -> bool:
        """Whether the grid holds any of the points that are compared, or a period is recorded."""
        return bool(self.report.periods) or bool(self.report.stick_slip)

    def figures(self) -> list[Figure]:
        """A raster for every point, then the loops of those whose period is known."""
        rasters = [raster(point, results) for point, results in self._results.items()]
        return [*rasters, *self._loops()]

    def context(self) -> dict[str, Any]:
        """The rows, and the periods that are missing."""
        unknown = [
            {"point": (case.title, eta), "title": variant.title, "reason": period.reason}
            for (case, eta), periods in self.report.periods.items()
            for variant, period in periods.items()
            if not period.known
        ]
        axes = self.result.sweep.case_axes
        rows = [
            {**row, "where": ", ".join(ratio(row[name]) for name in (*axes, "frequency_ratio"))}
            for row in self.report.stick_slip
        ]
        return {
            "axes": ", ".join(axis_name(name) for name in axes),
            "rows": rows,
            "window": MATCHING_WINDOW,
            "rasters": len(self._results),
            "points": [f"{case.title}, frequency ratio {ratio(eta)}" for case, eta in self._results],
            "unknown": unknown,
        }

    @cached_property
    def _results(self) -> dict[CasePoint, dict[Variant, Result]]:
        """Certified results of every variant but the converged reference, at the points that the grid holds."""
        by_point: dict[CasePoint, dict[Variant, Result]] = {}
        for point in compared_points(self.result)[:MOST_RASTERS]:
            points = [point_at(self.result, v, *point) for v in self.result.sweep.variants if v != CONVERGED]
            results = {p.variant: p.result for p in points if p is not None and p.result.converged}
            if REFERENCE in results:
                by_point[point] = results
        return by_point

    def _loops(self) -> list[Figure]:
        known = {
            point: {variant: period for variant, period in periods.items() if period.known}
            for point, periods in self.report.periods.items()
        }
        return [hysteresis(self.result.sweep, point, periods) for point, periods in known.items() if periods]
