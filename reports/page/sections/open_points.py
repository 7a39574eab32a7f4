"""Open points: what disagrees, is inconclusive or is blocked, by name and with its reason."""

import math
from collections import defaultdict
from collections.abc import Sequence
from typing import Any

from engines.interface.registry import engine
from engines.interface.variant import Variant
from reports.data.departures import outcome
from reports.drawing.style import compared_variants
from reports.page.section import Section
from scenarios.sweeps.sweep import Case
from scenarios.sweeps.table import Point
from scenarios.verdicts.finding import Finding, Prediction
from scenarios.verdicts.verdict import Verdict

LONGEST = 10
"""Rows of one variant that the page shows, the largest differences first; files hold all of them."""


class OpenPoints(Section):
    """Everything that does not agree, by variant; points with the same verdict and reason in one row."""

    title = "Points that do not agree"
    template = "open_points"

    def context(self) -> dict[str, Any]:
        """Variants with their open rows."""
        shown = []
        for variant in self.result.sweep.variants:
            rows = self._rows(variant)
            if rows:
                of = engine(variant.engine)
                known_deviation = of.preset(variant.formulation, variant.preset_name).known_deviation
                departs = f"Departs from Coulomb's law: {known_deviation}." if known_deviation else ""
                notes = " ".join(note for note in (of.capabilities.notes, departs) if note)
                left_out = max(len(rows) - LONGEST, 0)
                shown.append({"title": variant.title, "notes": notes, "rows": rows[:LONGEST], "left_out": left_out})
        return {"variants": shown, "compared": [variant.title for variant in compared_variants(self.result.sweep)]}

    def _rows(self, variant: Variant) -> list[dict[str, Any]]:
        reason = self.report.findings[variant].blocked
        if not self.result.points_of(variant):
            reason = "the dataset holds none of its points"
        if reason is not None:
            everywhere = "every point and every edge"
            blocked = {"verdict": str(Verdict.BLOCKED), "outcome": "", "law": "", "size": math.nan, "reason": reason}
            blocked |= {"difference": math.nan, "unit": ""}
            return [{"places": everywhere} | blocked]
        rows = [*self._edges(variant), *self._points(variant)]
        return sorted(rows, key=_order)

    def _points(self, variant: Variant) -> list[dict[str, Any]]:
        groups: dict[tuple[Case, Verdict, str], list[Point]] = defaultdict(list)
        for point in self.result.points_of(variant):
            verdict = point.comparison.verdict
            if verdict is not Verdict.AGREE:
                groups[point.case, verdict, point.comparison.reason].append(point)
        return [
            {
                "places": f"{case}, η_r = {', '.join(f'{point.frequency_ratio:g}' for point in points)}",
                **_judged(points[0].finding, points[0].findings),
            }
            for (case, _, _), points in groups.items()
        ]

    def _edges(self, variant: Variant) -> list[dict[str, Any]]:
        return [
            {
                "places": f"{edge.case}, {edge.edge} edge",
                **_judged(edge.finding, (edge.finding,)),
            }
            for edge in self.result.edges
            if edge.variant == variant and edge.comparison.verdict is not Verdict.AGREE
        ]


def _order(row: dict[str, Any]) -> tuple[bool, float]:
    """Differences in dB first, the largest of them on top; edges and what has no number after them."""
    return row["unit"] != "dB", 0.0 if math.isnan(row["difference"]) else -abs(row["difference"])


def _judged(finding: Finding, findings: Sequence[Finding]) -> dict[str, Any]:
    """Give the verdict, what the law says of it, and the reason; `findings` are all of the point."""
    comparison, prediction = finding.comparison, finding.prediction
    return {
        "verdict": str(comparison.verdict),
        "outcome": outcome(findings),
        "law": "" if prediction is None else _law(finding, prediction),
        "size": comparison.excess,
        "difference": comparison.difference,
        "unit": finding.metric.unit,
        "reason": comparison.reason,
    }


def _law(finding: Finding, prediction: Prediction) -> str:
    """Give departure, prediction and what is left; of a law without a steady state, that."""
    if not prediction.certified:
        return str(prediction)
    departure, left, unit = finding.comparison.difference, prediction.difference, finding.metric.unit
    text = (
        f"departure {departure:+.4g}, prediction {departure - left:+.4g}, left {left:+.2g} {unit}, "
        f"allowed {prediction.allowed:.2g}; period {prediction.distance:.2g} U0, allowed {prediction.period_bound:.2g}"
    )
    return text.replace("-", "−")
