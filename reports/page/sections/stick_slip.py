"""Stick and slip: transitions and stuck fractions at a few points, against the reference at equal time step."""

import math
from statistics import mean, median
from typing import Any

from engines.interface.variant import Variant
from reference_lcp.accuracy.convergence import STICK_SLIP_POINTS
from reference_lcp.observables.transition_matching import MATCHING_WINDOW, match_transitions
from reports.data.report import OperatingPoint
from reports.figures.figure import Figure
from reports.figures.hysteresis import hysteresis
from reports.figures.stick_slip import raster
from reports.page.section import Section
from scenarios.studies.figure3 import CONVERGED, REFERENCE, Figure3Result, Point
from scenarios.tasks.result import Result


class StickSlip(Section):
    """Modes over one period, hysteresis loops, and the rows of `stick_slip_rows`."""

    title = "Stick and slip"
    template = "stick_slip"

    def figures(self) -> list[Figure]:
        """A raster for every point, then the loops of those whose motion is known."""
        return [*self._rasters(), *self._loops()]

    def context(self) -> dict[str, Any]:
        """The rows, and what is missing among the motions."""
        unknown = [
            {"place": place, "title": variant.title, "reason": motion.reason}
            for place, motions in self.report.motions.items()
            for variant, motion in motions.items()
            if not motion.known
        ]
        rasters = len(self._answers())
        return {
            "rows": stick_slip_rows(self.result),
            "window": MATCHING_WINDOW,
            "rasters": rasters,
            "unknown": unknown,
        }

    def _answers(self) -> dict[OperatingPoint, dict[Variant, Result]]:
        """Certified answers of everybody but the converged reference, at the points that the grid holds."""
        found: dict[OperatingPoint, dict[Variant, Result]] = {}
        for place in STICK_SLIP_POINTS:
            points = [_at(self.result, v, *place) for v in self.result.asked.all_variants if v != CONVERGED]
            answers = {p.variant: p.answer for p in points if p is not None and p.answer.converged}
            if REFERENCE in answers:
                found[place] = answers
        return found

    def _rasters(self) -> list[Figure]:
        return [raster(place, answers) for place, answers in self._answers().items()]

    def _loops(self) -> list[Figure]:
        known = {
            place: {variant: motion for variant, motion in motions.items() if motion.known}
            for place, motions in self.report.motions.items()
        }
        return [hysteresis(self.result.asked, place, motions) for place, motions in known.items() if motions]


def stick_slip_rows(result: Figure3Result) -> list[dict[str, Any]]:
    """Compare modes of every variant with the reference's at the `STICK_SLIP_POINTS` that the grid holds.

    Fractions are parts of a period: `stuck_fraction` is the mean over the cells, `stuck_fraction_error`
    the largest of a cell, time errors are absolute values.
    """
    rows = []
    for friction, eta in STICK_SLIP_POINTS:
        expected = _at(result, REFERENCE, friction, eta)
        if expected is None or not expected.answer.converged:
            continue
        for variant in (REFERENCE, CONVERGED, *result.asked.all_variants[2:]):
            point = _at(result, variant, friction, eta)
            if point is not None:
                rows.append(_row(point, expected.answer))
    return rows


def _at(result: Figure3Result, variant: Variant, friction_ratio: float, frequency_ratio: float) -> Point | None:
    """Give the point of the grid that is there to round-off."""
    curve = result.curve(variant, friction_ratio)
    return next((p for p in curve if math.isclose(p.frequency_ratio, frequency_ratio, rel_tol=1e-9)), None)


def _row(point: Point, expected: Result) -> dict[str, Any]:
    """Compare one point; without a steady state there is only its status."""
    answer = point.answer
    row: dict[str, Any] = {
        "engine": point.variant.engine,
        "formulation": point.variant.formulation,
        "preset": point.variant.preset_name,
        "title": point.variant.title,
        "friction_ratio": point.friction_ratio,
        "frequency_ratio": point.frequency_ratio,
        "status": answer.status,
    }
    return {**row, **(_compared(answer, expected) if answer.converged else _nothing())}


def _compared(answer: Result, expected: Result) -> dict[str, Any]:
    match = match_transitions(answer.transitions, expected.transitions, expected.period)
    errors = [abs(error) for error in match.time_errors]
    pairs = zip(answer.stuck_fraction, expected.stuck_fraction, strict=True)
    return {
        "stuck_fraction": mean(answer.stuck_fraction),
        "stuck_fraction_error": max(abs(ours - theirs) for ours, theirs in pairs),
        "transitions": len(answer.transitions),
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
