"""Stick and slip at a few points, beside the reference's at equal time step."""

import math
from statistics import mean, median
from typing import Any

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.data.points import names_of
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.sweeps.compared import ComparedSweep
from multibody_xval.scenarios.sweeps.point import Point
from multibody_xval.scenarios.sweeps.sweep import Case
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE
from reference_lcp.defaults import STICK_SLIP_POINTS

CasePoint = tuple[Case, float]
"""Case and frequency ratio."""

COMPARED = (
    "stuck_fraction", "stuck_fraction_error", "transitions", "missed", "spurious", "median_time_error",
    "largest_time_error",
)  # fmt: skip
"""Numbers of a row, all of them ``None`` where there is no steady state."""


def stick_slip_places(result: ComparedSweep) -> list[CasePoint]:
    """Give the `STICK_SLIP_POINTS` in every case of their friction ratio; where the grid has none, `_most_mixed`."""
    usual = [
        (case, eta) for friction, eta in STICK_SLIP_POINTS for case in result.cases if case.friction_ratio == friction
    ]
    held = [place for place in usual if REFERENCE in points_at(result, *place)]
    return held or [place for case in result.cases for place in _most_mixed(result, case)]


def _most_mixed(result: ComparedSweep, case: Case) -> list[CasePoint]:
    """Give the point of a case at which the reference sticks nearest half of the time; none where it never changes."""
    curve = [point for point in result.curve(REFERENCE, case) if point.result.converged and point.result.transitions]
    nearest = min(curve, key=lambda point: abs(mean(point.result.stuck_fraction) - 0.5), default=None)
    return [] if nearest is None else [(case, nearest.frequency_ratio)]


def points_at(result: ComparedSweep, case: Case, frequency_ratio: float) -> dict[Variant, Point]:
    """Give the point of the reference and of every variant whose curve holds it, to round-off."""
    return {
        point.variant: point
        for variant in (REFERENCE, *result.sweep.variants)
        for point in result.curve(variant, case)
        if math.isclose(point.frequency_ratio, frequency_ratio, rel_tol=1e-9)
    }


def stick_slip_rows(result: ComparedSweep) -> list[dict[str, Any]]:
    """Compare modes of every variant with the reference's at the `stick_slip_places` that the grid holds.

    Fractions are parts of a period: `stuck_fraction` is the mean over the cells, `stuck_fraction_error`
    the largest of a cell, time errors are absolute values.
    """
    rows = []
    for place in stick_slip_places(result):
        points = points_at(result, *place)
        if REFERENCE in points and points[REFERENCE].result.converged:
            rows += [_row(point, points[REFERENCE].result) for point in points.values()]
    return rows


def _row(point: Point, expected: Result) -> dict[str, Any]:
    """Compare one point; without a steady state there is only its status."""
    return {
        **names_of(point.variant),
        "title": point.variant.title,
        **point.case.by_axis,
        "frequency_ratio": point.frequency_ratio,
        "status": point.result.status,
        **(_compared(point.result, expected) if point.result.converged else dict.fromkeys(COMPARED)),
    }


def _compared(result: Result, expected: Result) -> dict[str, Any]:
    match = result.matched(expected.transitions)
    errors = [abs(error) for error in match.time_errors]
    numbers = (
        mean(result.stuck_fraction), result.stuck_difference(expected), len(result.transitions), len(match.missed),
        len(match.spurious), median(errors) if errors else math.nan, max(errors, default=math.nan),
    )  # fmt: skip
    return dict(zip(COMPARED, numbers, strict=True))
