"""Summary: every variant in one row, and what it was compared with."""

from dataclasses import dataclass
from typing import Any, ClassVar

from engines.registry import engine
from engines.variant import Variant
from reports.findings import band_definition, blocked_reason, compared_with, findings
from scenarios.agreement import EDGE_TOLERANCE, FLOOR_DB, Verdict
from scenarios.figure3 import CONVERGED, Figure3Result


@dataclass(frozen=True)
class Summary:
    """One row a variant."""

    result: Figure3Result
    title: ClassVar[str] = "Summary"
    template: ClassVar[str] = "summary"

    def context(self) -> dict[str, Any]:
        """Rows, the headline and the definitions that they need."""
        compared = [v for v in self.result.asked.all_variants if v != CONVERGED]
        return {
            "rows": [self._row(variant) for variant in self.result.asked.all_variants],
            "headline": self._headline(compared),
            "band": band_definition(self.result),
            "floor": FLOOR_DB,
            "edge_tolerance": EDGE_TOLERANCE,
            "friction_ratios": self.result.asked.friction_ratios,
            "first": self.result.asked.frequency_ratios[0],
            "last": self.result.asked.frequency_ratios[-1],
            "cells": self.result.asked.ratios.cells,
            "verdicts": [str(verdict) for verdict in Verdict],
        }

    def _row(self, variant: Variant) -> dict[str, Any]:
        return {
            "variant": variant,
            "found": findings(self.result, variant),
            "friction_law": str(engine(variant.engine).capabilities.friction_law),
            "compared_with": compared_with(variant),
            "blocked": blocked_reason(self.result, variant),
            "is_ruler": variant == CONVERGED,
        }

    def _headline(self, compared: list[Variant]) -> dict[str, int]:
        """Count points by verdict over all that is compared."""
        counts = [findings(self.result, variant).verdicts for variant in compared]
        return {str(verdict): sum(count[verdict] for count in counts) for verdict in Verdict}
