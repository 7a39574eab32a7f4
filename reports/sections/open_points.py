"""Open points: what disagrees, is inconclusive or is blocked, by name and with its reason."""

from collections import defaultdict
from dataclasses import dataclass
from typing import Any, ClassVar

from engines.registry import engine
from engines.variant import Variant
from reports.findings import blocked_reason
from scenarios.agreement import Verdict
from scenarios.figure3 import Figure3Result


@dataclass(frozen=True)
class OpenPoints:
    """Everything that does not agree, by variant; points with the same verdict and reason in one row."""

    result: Figure3Result
    title: ClassVar[str] = "Points that do not agree"
    template: ClassVar[str] = "open_points"

    def context(self) -> dict[str, Any]:
        """Variants with their open rows."""
        open_ones = []
        for variant in self.result.asked.all_variants:
            rows = self._rows(variant)
            if rows:
                open_ones.append(
                    {"title": variant.title, "notes": engine(variant.engine).capabilities.notes, "rows": rows}
                )
        return {"variants": open_ones}

    def _rows(self, variant: Variant) -> list[dict[str, str]]:
        reason = blocked_reason(self.result, variant)
        if reason is not None:
            return [{"places": "every point and every edge", "verdict": str(Verdict.BLOCKED), "reason": reason}]
        return [*self._points(variant), *self._edges(variant)]

    def _points(self, variant: Variant) -> list[dict[str, str]]:
        places: dict[tuple[float, Verdict, str], list[str]] = defaultdict(list)
        for point in self.result.points:
            verdict = point.comparison.verdict
            if point.variant == variant and verdict is not Verdict.AGREE:
                places[point.friction_ratio, verdict, point.comparison.reason].append(f"{point.frequency_ratio:g}")
        return [
            {"places": f"friction {friction:g}, η_r = {', '.join(etas)}", "verdict": str(verdict), "reason": reason}
            for (friction, verdict, reason), etas in places.items()
        ]

    def _edges(self, variant: Variant) -> list[dict[str, str]]:
        compared = [(e, e.comparison) for e in self.result.edges if e.variant == variant]
        return [
            {
                "places": f"friction {edge.friction_ratio:g}, {edge.edge} edge",
                "verdict": str(comparison.verdict),
                "reason": comparison.reason,
            }
            for edge, comparison in compared
            if comparison.verdict is not Verdict.AGREE
        ]
