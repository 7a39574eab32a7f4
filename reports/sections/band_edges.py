"""Band edges: every variant's edges and their differences from the converged reference's."""

from dataclasses import dataclass
from typing import Any, ClassVar

from markupsafe import Markup

from engines.variant import Variant
from reports.figures import edge_forest
from reports.findings import absent_edge, band_definition
from scenarios.agreement import EDGE_TOLERANCE
from scenarios.attenuation_band import EDGE_RESOLUTION, Edge
from scenarios.figure3 import CONVERGED, Figure3Result


@dataclass(frozen=True)
class BandEdges:
    """A table of edges and a figure of their differences."""

    result: Figure3Result
    title: ClassVar[str] = "Band edges"
    template: ClassVar[str] = "band_edges"

    def context(self) -> dict[str, Any]:
        """Rows, one a friction ratio and edge; cells, one a variant."""
        variants = self.result.asked.all_variants
        return {
            "variants": variants,
            "rows": [
                {
                    "friction_ratio": friction,
                    "edge": str(edge),
                    "cells": [self._cell(v, friction, edge) for v in variants],
                }
                for friction in self.result.asked.friction_ratios
                for edge in Edge
            ],
            "forest": Markup(edge_forest(self.result)),
            "band": band_definition(self.result),
            "tolerance": EDGE_TOLERANCE,
            "resolution": EDGE_RESOLUTION,
        }

    def _cell(self, variant: Variant, friction_ratio: float, edge: Edge) -> dict[str, Any]:
        found = self.result.edge(variant, friction_ratio, edge)
        comparison = found.comparison
        return {
            "frequency_ratio": found.frequency_ratio,
            "absent": absent_edge(self.result, found),
            "difference": comparison.difference,
            "verdict": str(comparison.verdict),
            "is_ruler": variant == CONVERGED,
        }
