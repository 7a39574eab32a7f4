"""Stick and slip at a few points, beside the reference's at equal time step."""

import math
from statistics import mean, median
from typing import Any

from engines.interface.variant import Variant
from reference_lcp.studies.against_exact import STICK_SLIP_POINTS
from scenarios.runs.result import Result
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.point import Point
from scenarios.sweeps.sweep import Case
from scenarios.verdicts.steady_case import REFERENCE

CasePoint = tuple[Case, float]
"""Case and frequency ratio."""

COMPARED = (
    "stuck_fraction", "stuck_fraction_error", "transitions", "missed", "spurious", "median_time_error",
    "largest_time_error",
)  # fmt: skip
"""Numbers of a row, all of them ``None`` where there is no steady state."""


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
        expected = point_at(result, REFERENCE, *compared)
        if expected is None or not expected.result.converged:
            continue
        for variant in dict.fromkeys((REFERENCE, *result.sweep.variants)):
            point = point_at(result, variant, *compared)
            if point is not None:
                rows.append(_row(point, expected.result))
    return rows


def point_at(result: ComparedSweep, variant: Variant, case: Case, frequency_ratio: float) -> Point | None:
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
    return row | (_compared(result, expected) if result.converged else dict.fromkeys(COMPARED))


def _compared(result: Result, expected: Result) -> dict[str, Any]:
    match = result.matched(expected.transitions)
    errors = [abs(error) for error in match.time_errors]
    return {
        "stuck_fraction": mean(result.stuck_fraction),
        "stuck_fraction_error": result.stuck_difference(expected),
        "transitions": len(result.transitions),
        "missed": len(match.missed),
        "spurious": len(match.spurious),
        "median_time_error": median(errors) if errors else math.nan,
        "largest_time_error": max(errors, default=math.nan),
    }
