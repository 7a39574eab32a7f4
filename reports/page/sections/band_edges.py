"""Band edges: every variant's edges and their differences from the converged reference's."""

from typing import Any

from engines.interface.variant import Variant
from reports.data.findings import absent_edge, band_definition
from reports.figures.edges import edge_forest, reference_error
from reports.figures.figure import Figure
from reports.page.section import Section
from scenarios.studies.attenuation_band import EDGE_RESOLUTION, Edge
from scenarios.studies.figure3 import CONVERGED


class BandEdges(Section):
    """A table of edges and a figure of their differences."""

    title = "Band edges"
    template = "band_edges"

    def figures(self) -> list[Figure]:
        """The forest."""
        return [edge_forest(self.result)]

    def context(self) -> dict[str, Any]:
        """Rows, one a friction ratio and edge; cells, one a variant."""
        variants = self.result.asked.all_variants
        return {
            "variants": variants,
            "rows": [
                {
                    "friction_ratio": friction,
                    "edge": str(edge),
                    "error_bar": reference_error(self.result, (friction, edge)),
                    "cells": [self._cell(v, friction, edge) for v in variants],
                }
                for friction in self.result.asked.friction_ratios
                for edge in Edge
            ],
            "band": band_definition(self.result),
            "resolution": EDGE_RESOLUTION,
        }

    def _cell(self, variant: Variant, friction_ratio: float, edge: Edge) -> dict[str, Any]:
        found = self.result.edge(variant, friction_ratio, edge)
        comparison = found.comparison
        return {
            "frequency_ratio": found.frequency_ratio,
            "absent": absent_edge(self.result, found),
            "difference": comparison.difference,
            "allowed": comparison.tolerance,
            "verdict": str(comparison.verdict),
            "is_ruler": variant == CONVERGED,
        }
