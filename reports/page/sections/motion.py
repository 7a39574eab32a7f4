"""What the chain does: transmittance, edges of the band, the map over friction and frequency, stick and slip."""

import math
from functools import cached_property
from typing import Any

from engines.interface.tolerances import CONVERGED_TOLERANCE_DB
from engines.interface.variant import Variant
from reference_lcp.observables.stick_slip import MATCHING_WINDOW
from reports.data.descriptions import axis_name
from reports.data.points import outcome
from reports.data.stick_slip import CasePoint, compared_points, point_at
from reports.drawing.figure import Figure
from reports.figures.edges import edge_forest, reference_error
from reports.figures.stick_slip import hysteresis, raster
from reports.figures.transmittance import (
    LINEAR_DB,
    LOWEST_DB,
    MAP_HIGHEST_DB,
    MAP_LOWEST_DB,
    friction_map_figure,
    overview,
    panel,
)
from reports.formatting import ratio
from reports.page.section import Section
from scenarios.runs.result import Result
from scenarios.sweeps.attenuation_band import EDGE_RESOLUTION, Edge
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.edges import BandEdge
from scenarios.sweeps.sweep import Case
from scenarios.verdicts.finding import FLOOR_DB
from scenarios.verdicts.steady_case import CONVERGED, REFERENCE

MOST_PANELS = 24
"""Cases that the page shows, so that it stays small enough to be sent; the files hold all of them."""


class Transmittance(Section):
    """The paper's Figure 3 by the reference, then a panel a case with every variant."""

    title = "Transmittance"
    template = "transmittance"
    numbers = "transmittance.csv"

    def figures(self) -> list[Figure]:
        """The overview, then the panels."""
        lines = [overview(self.result)] if REFERENCE in self.result.sweep.variants else []
        return [*lines, *(panel(self.result, case) for case in self.result.cases[:MOST_PANELS])]

    def context(self) -> dict[str, Any]:
        """What the captions name."""
        return {
            "panels": min(len(self.result.cases), MOST_PANELS),
            "left_out": max(len(self.result.cases) - MOST_PANELS, 0),
            "over": "P0 / k_c" if self.result.sweep.excitation.kind == "force" else "the base's",
            "floor": FLOOR_DB,
            "lowest": LOWEST_DB,
            "linear": LINEAR_DB,
            "tolerance": CONVERGED_TOLERANCE_DB,
        }


class BandEdges(Section):
    """A table of edges and a figure of their differences."""

    title = "Band edges"
    template = "band_edges"
    numbers = "band_edges.csv"

    @property
    def shown(self) -> bool:
        """Whether any edge was refined."""
        return bool(self.result.edges)

    def figures(self) -> list[Figure]:
        """The forest."""
        return [edge_forest(self.result)]

    def context(self) -> dict[str, Any]:
        """Rows, one a case and edge; cells, one a variant."""
        variants = self.result.sweep.variants
        return {
            "variants": variants,
            "axes": [axis_name(name) for name in self.result.sweep.case_axes],
            "rows": [
                {
                    "values": [ratio(value) for value in case.by_axis.values()],
                    "edge": str(edge),
                    "error_bar": reference_error(self.result, (case, edge)),
                    "cells": [self._cell(v, case, edge) for v in variants],
                }
                for case in self.result.cases
                for edge in Edge
            ],
            "resolution": EDGE_RESOLUTION,
        }

    def _cell(self, variant: Variant, case: Case, edge: Edge) -> dict[str, Any]:
        band_edge = self.result.edge(variant, case, edge)
        comparison = band_edge.comparison
        return {
            "frequency_ratio": band_edge.frequency_ratio,
            "absent": absent_edge(self.result, band_edge),
            "difference": comparison.difference,
            "allowed": comparison.tolerance,
            "verdict": str(comparison.verdict),
            "outcome": outcome((band_edge.finding,)),
            "left": math.nan if band_edge.prediction is None else band_edge.prediction.difference,
            "is_baseline": variant == CONVERGED,
        }


def absent_edge(result: ComparedSweep, edge: BandEdge) -> str:
    """Describe an edge that the grid does not hold."""
    curve = [point for point in result.curve(edge.variant, edge.case) if point.result.converged]
    if not curve:
        return "unknown"
    if all(point.result.transmittance_db >= result.sweep.band.depth_db for point in curve):
        return "none"
    if edge.edge is Edge.LOWER:
        return f"below {curve[0].frequency_ratio:g}"
    return f"above {curve[-1].frequency_ratio:g}"


class FrictionMapSection(Section):
    """The map of the reference, with the contour of the band."""

    title = "Friction and frequency"
    template = "friction_map"

    @property
    def shown(self) -> bool:
        """Whether any point of the map is known."""
        return self.report.friction_map is not None and self.report.friction_map.known > 0

    def figures(self) -> list[Figure]:
        """The map."""
        data = self.report.friction_map
        return [] if data is None else [friction_map_figure(data)]

    def context(self) -> dict[str, Any]:
        """What the caption names, and how much is missing."""
        data = self.report.friction_map
        return {
            "lowest": MAP_LOWEST_DB,
            "highest": MAP_HIGHEST_DB,
            "points": 0 if data is None else data.transmittance_db.size,
            "known": 0 if data is None else data.known,
        }


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
