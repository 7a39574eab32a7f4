"""Band edges: every variant's edges and their differences from those of what it is compared with."""

import math
from typing import Any

from engines.interface.variant import Variant
from reports.data.departures import outcome
from reports.data.descriptions import axis_name
from reports.drawing.figure import Figure
from reports.figures.edges import edge_forest, reference_error
from reports.formatting import ratio
from reports.page.section import Section
from scenarios.sweeps.attenuation_band import EDGE_RESOLUTION, Edge
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.edges import BandEdge
from scenarios.sweeps.sweep import Case
from scenarios.verdicts.pointwise import CONVERGED


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
