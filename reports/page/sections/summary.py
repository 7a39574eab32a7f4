"""Summary: every variant in one row, and what it was compared with."""

from typing import Any

from engines.interface.registry import engine
from engines.interface.variant import Variant
from reports.data.findings import band_definition, blocked_reason, compared_with, drive_description, findings
from reports.page.section import Section
from scenarios.studies.figure3 import CONVERGED
from scenarios.verdicts.finding import FLOOR_DB
from scenarios.verdicts.verdict import Verdict


class Summary(Section):
    """One row a variant."""

    title = "Summary"
    template = "summary"

    def context(self) -> dict[str, Any]:
        """Rows, the headline and the definitions that they need."""
        asked = self.result.asked
        rows = [self._row(variant) for variant in asked.all_variants]
        compared = [row for row in rows if not row["is_ruler"]]
        verdicts = [str(verdict) for verdict in Verdict]
        return {
            "rows": rows,
            "headline": {verdict: sum(row["found"].verdicts[verdict] for row in compared) for verdict in verdicts},
            "missing": sum(row["missing"] for row in rows),
            "sentences": self._sentences(compared),
            "band": band_definition(self.result),
            "floor": FLOOR_DB,
            "friction_ratios": asked.friction_ratios,
            "first": asked.frequency_ratios[0],
            "last": asked.frequency_ratios[-1],
            "cells": asked.ratios.cells,
            "drive": drive_description(asked),
            "verdicts": verdicts,
        }

    def _row(self, variant: Variant) -> dict[str, Any]:
        return {
            "variant": variant,
            "found": findings(self.result, variant),
            "points": len(self.result.points_of(variant)),
            "missing": self.report.missing.get(variant, 0),
            "friction_law": str(engine(variant.engine).capabilities.friction_law),
            "compared_with": compared_with(variant, self.result.asked.tolerance),
            "blocked": blocked_reason(self.result, variant),
            "is_ruler": variant == CONVERGED,
        }

    @staticmethod
    def _sentences(rows: list[dict[str, Any]]) -> dict[str, list[str]]:
        """Sort engines by how they fared: all points agree, most do, few do, none were answered."""
        sorted_rows: dict[str, list[str]] = {"all": [], "some": [], "blocked": []}
        for row in rows:
            if row["variant"].engine == CONVERGED.engine:
                continue
            title, agreed, points = row["variant"].title, row["found"].verdicts["agree"], row["points"]
            if row["blocked"] is not None:
                sorted_rows["blocked"].append(title)
            elif agreed == points:
                sorted_rows["all"].append(title)
            else:
                sorted_rows["some"].append(f"{title} ({agreed} of {points})")
        return sorted_rows
