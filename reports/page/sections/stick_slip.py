"""Stick and slip: transitions and stuck fractions at a few points, against the reference at equal time step."""

import math
from statistics import mean, median
from typing import Any

from engines.interface.variant import Variant
from reference_lcp.accuracy.convergence import STICK_SLIP_POINTS
from reference_lcp.observables.transition_matching import MATCHING_WINDOW, match_transitions
from reports.data.findings import CasePoint, axis_name
from reports.figures.figure import Figure
from reports.figures.hysteresis import hysteresis
from reports.figures.stick_slip import raster
from reports.formatting import ratio
from reports.page.section import Section
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.sweep import Case
from scenarios.sweeps.table import Point
from scenarios.tasks.result import Result
from scenarios.verdicts.pointwise import CONVERGED
from scenarios.verdicts.steady_case import REFERENCE

MOST_RASTERS = 12
"""Most points that are drawn; a sweep over more than friction holds each of them many times."""


class StickSlip(Section):
    """Modes over one period, hysteresis loops, and the rows of `stick_slip_rows`."""

    title = "Stick and slip"
    template = "stick_slip"

    @property
    def shown(self) -> bool:
        """Whether the grid holds any of the points that are compared, or a period is recorded."""
        return bool(self.report.periods) or bool(stick_slip_rows(self.result))

    def figures(self) -> list[Figure]:
        """A raster for every point, then the loops of those whose period is known."""
        return [*self._rasters(), *self._loops()]

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
            for row in stick_slip_rows(self.result)
        ]
        return {
            "axes": ", ".join(axis_name(name) for name in axes),
            "rows": rows,
            "window": MATCHING_WINDOW,
            "rasters": len(self._results()),
            "unknown": unknown,
        }

    def _results(self) -> dict[CasePoint, dict[Variant, Result]]:
        """Certified results of every variant but the converged reference, at the points that the grid holds."""
        by_point: dict[CasePoint, dict[Variant, Result]] = {}
        for point in compared_points(self.result)[:MOST_RASTERS]:
            points = [_at(self.result, v, *point) for v in self.result.sweep.variants if v != CONVERGED]
            results = {p.variant: p.result for p in points if p is not None and p.result.converged}
            if REFERENCE in results:
                by_point[point] = results
        return by_point

    def _rasters(self) -> list[Figure]:
        return [raster(point, results) for point, results in self._results().items()]

    def _loops(self) -> list[Figure]:
        known = {
            point: {variant: period for variant, period in periods.items() if period.known}
            for point, periods in self.report.periods.items()
        }
        return [hysteresis(self.result.sweep, point, periods) for point, periods in known.items() if periods]


def compared_points(result: ComparedSweep) -> list[CasePoint]:
    """Give the `STICK_SLIP_POINTS` in every case of their friction ratio."""
    return [
        (case, eta) for friction, eta in STICK_SLIP_POINTS for case in result.cases if case.friction_ratio == friction
    ]


def stick_slip_rows(result: ComparedSweep) -> list[dict[str, Any]]:
    """Compare modes of every variant with the reference's at the `compared_points` that the grid holds.

    Fractions are parts of a period: `stuck_fraction` is the mean over the cells, `stuck_fraction_error`
    the largest of a cell, time errors are absolute values.
    """
    rows = []
    for compared in compared_points(result):
        expected = _at(result, REFERENCE, *compared)
        if expected is None or not expected.result.converged:
            continue
        for variant in dict.fromkeys((REFERENCE, *result.sweep.variants)):
            point = _at(result, variant, *compared)
            if point is not None:
                rows.append(_row(point, expected.result))
    return rows


def _at(result: ComparedSweep, variant: Variant, case: Case, frequency_ratio: float) -> Point | None:
    """Give the point of the grid that is there to round-off."""
    curve = result.curve(variant, case)
    return next((p for p in curve if math.isclose(p.frequency_ratio, frequency_ratio, rel_tol=1e-9)), None)


def _row(point: Point, expected: Result) -> dict[str, Any]:
    """Compare one point; without a steady state there is only its status."""
    result = point.result
    row: dict[str, Any] = {
        "engine": point.variant.engine,
        "formulation": point.variant.formulation,
        "preset": point.variant.preset_name,
        "title": point.variant.title,
        **point.case.by_axis,
        "frequency_ratio": point.frequency_ratio,
        "status": result.status,
    }
    return {**row, **(_compared(result, expected) if result.converged else _nothing())}


def _compared(result: Result, expected: Result) -> dict[str, Any]:
    match = match_transitions(result.transitions, expected.transitions, expected.period)
    errors = [abs(error) for error in match.time_errors]
    pairs = zip(result.stuck_fraction, expected.stuck_fraction, strict=True)
    return {
        "stuck_fraction": mean(result.stuck_fraction),
        "stuck_fraction_error": max(abs(ours - theirs) for ours, theirs in pairs),
        "transitions": len(result.transitions),
        "missed": len(match.missed),
        "spurious": len(match.spurious),
        "median_time_error": median(errors) if errors else math.nan,
        "largest_time_error": max(errors, default=math.nan),
    }


def _nothing() -> dict[str, Any]:
    return {
        "stuck_fraction": math.nan,
        "stuck_fraction_error": math.nan,
        "transitions": None,
        "missed": None,
        "spurious": None,
        "median_time_error": math.nan,
        "largest_time_error": math.nan,
    }
