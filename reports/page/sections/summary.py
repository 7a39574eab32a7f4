"""Summary: every variant in one row, and what it was compared with."""

from typing import Any

from engines.interface.registry import engine
from engines.interface.variant import Variant
from reports.data.descriptions import axis_name, band_definition, compared_with, drive_description
from reports.formatting import ratio
from reports.page.section import Section
from scenarios.verdicts.finding import FLOOR_DB
from scenarios.verdicts.pointwise import CONVERGED
from scenarios.verdicts.verdict import Verdict


class Summary(Section):
    """One row a variant."""

    title = "Summary"
    template = "summary"

    def context(self) -> dict[str, Any]:
        """Rows, the headline and the definitions that they need."""
        sweep = self.result.sweep
        rows = [self._row(variant) for variant in sweep.variants]
        compared = [row for row in rows if not row["is_baseline"]]
        verdicts = [str(verdict) for verdict in Verdict]
        return {
            "rows": rows,
            "headline": {verdict: sum(row["findings"].verdicts[verdict] for row in compared) for verdict in verdicts},
            "failures": self.report.failures,
            "missing": sum(row["missing"] for row in rows),
            "sentences": self._sentences(compared),
            "band": band_definition(self.result.sweep),
            "floor": FLOOR_DB,
            "axes": [
                (axis_name(name, plural=True), [ratio(value) for value in sweep.axes[name]]) for name in sweep.case_axes
            ],
            "axes_of_points": ", ".join(axis_name(name) for name in sweep.case_axes),
            "has_edges": bool(self.result.edges),
            "complete_by_command": not self.report.recorded,
            "first": sweep.frequency_ratios[0],
            "last": sweep.frequency_ratios[-1],
            "cells": " or ".join(ratio(n) for n in sweep.axes.get("cells", (sweep.ratios.cells,))),
            "drive": drive_description(sweep),
            "verdicts": verdicts,
        }

    def _row(self, variant: Variant) -> dict[str, Any]:
        return {
            "variant": variant,
            "findings": self.report.findings[variant],
            "points": len(self.result.points_of(variant)),
            "missing": self.report.missing.get(variant, 0),
            "friction_law": str(engine(variant.engine).capabilities.friction_law),
            "compared_with": compared_with(variant, self.result.sweep.tolerance),
            "is_baseline": variant == CONVERGED,
        }

    @staticmethod
    def _sentences(rows: list[dict[str, Any]]) -> dict[str, list[str]]:
        """Group variants: all points agree, some do, or the variant is blocked."""
        sorted_rows: dict[str, list[str]] = {"all": [], "some": [], "blocked": []}
        for row in rows:
            if row["variant"].engine == CONVERGED.engine:
                continue
            title, agreed, points = row["variant"].title, row["findings"].verdicts["agree"], row["points"]
            if row["findings"].blocked is not None:
                sorted_rows["blocked"].append(title)
            elif agreed == points:
                sorted_rows["all"].append(title)
            else:
                sorted_rows["some"].append(f"{title} ({agreed} of {points})")
        return sorted_rows
