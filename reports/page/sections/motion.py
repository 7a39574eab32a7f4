"""What the chain does: transmittance, edges of the band, the map over friction and frequency, stick and slip."""

from functools import cached_property
from typing import Any

from multibody_xval.engines.interface.tolerances import CONVERGED_TOLERANCE_DB
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.data.descriptions import axis_name
from multibody_xval.reports.data.points import rows_of
from multibody_xval.reports.data.stick_slip import CasePoint, points_at, stick_slip_places
from multibody_xval.reports.figures.drawing import Drawing
from multibody_xval.reports.figures.edges import edge_forest
from multibody_xval.reports.figures.stick_slip import hysteresis, raster
from multibody_xval.reports.figures.transmittance import (
    FIGURE3,
    LINEAR_DB,
    LOWEST_DB,
    MAP_HIGHEST_DB,
    MAP_LOWEST_DB,
    friction_map_figure,
    overview,
    panel,
    responses,
)
from multibody_xval.reports.formatting import ratio
from multibody_xval.reports.page.section import Section
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.sweeps.attenuation_band import EDGE_RESOLUTION, Edge
from multibody_xval.scenarios.verdicts.finding import FLOOR_DB
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED, REFERENCE
from reference_lcp.observables.stick_slip import MATCHING_WINDOW

MOST_PANELS = 24
"""Cases that the page shows, so that it stays small enough to be sent; the files hold all of them."""


class Transmittance(Section):
    """The paper's Figure 3 by the reference, then a panel a case with every variant."""

    title = "Transmittance"
    template = "transmittance"
    numbers = "transmittance.csv"

    def figures(self) -> list[Drawing]:
        lines = responses(self.report)
        if REFERENCE in self.result.sweep.variants and not any(own.name == FIGURE3 for own in lines):
            lines = [overview(self.report), *lines]
        return [*lines, *(panel(self.report, case) for case in self.result.cases[:MOST_PANELS])]

    def context(self) -> dict[str, Any]:
        return {
            "panels": min(len(self.result.cases), MOST_PANELS),
            "cases": [case.title for case in self.result.cases[:MOST_PANELS]],
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
        return bool(self.result.edges) or self.report.of_dataset

    def figures(self) -> list[Drawing]:
        return [edge_forest(self.report)] if self.result.edges else []

    def context(self) -> dict[str, Any]:
        variants = self.result.sweep.variants
        cells = {(row.variant, row.case, row.edge): row for row in rows_of(self.report.edges)}
        return {
            "variants": variants,
            "baseline": CONVERGED,
            "axes": [axis_name(name) for name in self.result.sweep.case_axes],
            "rows": [
                {
                    "values": [ratio(value) for value in case.by_axis.values()],
                    "edge": str(edge),
                    "error_bar": cells[REFERENCE, case, edge].allowed,
                    "cells": [cells[variant, case, edge] for variant in variants],
                }
                for case in (self.result.cases if self.result.edges else ())
                for edge in Edge
            ],
            "resolution": EDGE_RESOLUTION,
        }


class FrictionMapSection(Section):
    """The map of the reference, with the contour of the band."""

    title = "Friction and frequency"
    template = "friction_map"

    @property
    def shown(self) -> bool:
        return self.report.friction_map is not None and self.report.friction_map.known > 0

    def figures(self) -> list[Drawing]:
        data = self.report.friction_map
        return [] if data is None else [friction_map_figure(data)]

    def context(self) -> dict[str, Any]:
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
        return bool(self.report.periods) or bool(self.report.stick_slip)

    def figures(self) -> list[Drawing]:
        rasters = [raster(point, results) for point, results in self._results.items()]
        return [*rasters, *self._loops()]

    def context(self) -> dict[str, Any]:
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
        by_point = {}
        for place in stick_slip_places(self.result)[:MOST_RASTERS]:
            points = points_at(self.result, *place)
            results = {v: p.result for v, p in points.items() if v != CONVERGED and p.result.converged}
            if REFERENCE in results:
                by_point[place] = {v: results[v] for v in self.result.sweep.variants if v in results}
        return by_point

    def _loops(self) -> list[Drawing]:
        known = {
            point: {variant: period for variant, period in periods.items() if period.known}
            for point, periods in self.report.periods.items()
        }
        return [hysteresis(point, periods) for point, periods in known.items() if periods]
