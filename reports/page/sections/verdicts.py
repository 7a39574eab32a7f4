"""Verdicts: how many points of every variant agree with what it should equal."""

import math
from typing import Any

from engines.interface.registry import engine
from engines.interface.variant import Variant
from reports.data.descriptions import axis_name, compared_with
from reports.page.section import Section
from scenarios.verdicts.finding import FLOOR_DB
from scenarios.verdicts.pointwise import CONVERGED
from scenarios.verdicts.steady_case import REFERENCE
from scenarios.verdicts.verdict import Verdict


class Verdicts(Section):
    """One row a variant, and what the comparison comes to; the reference beside itself counts nowhere."""

    title = "Verdicts"
    template = "verdicts"

    def context(self) -> dict[str, Any]:
        """Rows, tiles and sentences; the converged reference is compared with nothing."""
        sweep = self.result.sweep
        rows = [self._row(variant) for variant in sweep.variants]
        compared = [row for row in rows if row["variant"].engine != REFERENCE.engine]
        verdicts = [str(verdict) for verdict in Verdict]
        return {
            "rows": rows,
            "headline": {verdict: sum(row["findings"].verdicts[verdict] for row in compared) for verdict in verdicts},
            "failures": self.report.failures,
            "missing": sum(row["missing"] for row in rows),
            "sentences": self._sentences(compared),
            "floor": FLOOR_DB,
            "axes_of_points": ", ".join(axis_name(name) for name in sweep.case_axes),
            "verdicts": verdicts,
        }

    def _row(self, variant: Variant) -> dict[str, Any]:
        findings, points = self.report.findings[variant], len(self.result.points_of(variant))
        return {
            "variant": variant,
            "findings": findings,
            "points": points,
            "seconds": findings.seconds / points if points else math.nan,
            "missing": self.report.missing.get(variant, 0),
            "friction_law": str(engine(variant.engine).capabilities.friction_law),
            "compared_with": compared_with(variant, self.result.sweep.tolerance),
            "is_baseline": variant == CONVERGED,
        }

    @staticmethod
    def _sentences(rows: list[dict[str, Any]]) -> dict[str, list[str]]:
        """Group variants: all points agree, some do, or there is nothing that could be compared."""
        sorted_rows: dict[str, list[str]] = {"all": [], "some": [], "nothing": []}
        for row in rows:
            title, agreed, points = row["variant"].title, row["findings"].verdicts["agree"], row["points"]
            if row["findings"].blocked is not None or points == row["missing"]:
                sorted_rows["nothing"].append(title)
            elif agreed == points:
                sorted_rows["all"].append(title)
            else:
                sorted_rows["some"].append(f"{title} ({agreed} of {points})")
        return sorted_rows
