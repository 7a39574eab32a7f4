"""What comparisons come to: verdicts, deviations and laws, the catalogue, and points that do not agree."""

import math
from collections import defaultdict
from collections.abc import Sequence
from typing import Any

from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.data.catalogue import SIGNS, cell_of
from multibody_xval.reports.data.descriptions import axis_name
from multibody_xval.reports.data.points import outcome
from multibody_xval.reports.data.report import counted
from multibody_xval.reports.figures.style import compared_variants
from multibody_xval.reports.page.section import Section
from multibody_xval.reports.reproducers.script import has_reproducer
from multibody_xval.scenarios.catalogue.registry import CATALOGUE
from multibody_xval.scenarios.sweeps.point import Point
from multibody_xval.scenarios.sweeps.sweep import Case
from multibody_xval.scenarios.verdicts.finding import FLOOR_DB, Comparison, Finding, Metric, Prediction, Verdict
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE


class Verdicts(Section):
    """One row a variant, and what the comparison comes to; the reference beside itself counts nowhere."""

    title = "Verdicts"
    template = "verdicts"

    def context(self) -> dict[str, Any]:
        sweep = self.result.sweep
        rows = [self._row(variant) for variant in sweep.variants if variant.engine != REFERENCE.engine]
        return {
            "rows": rows,
            "counts": list(counted(())),
            "status": self.report.status,
            "failures": self.report.failures,
            "missing": sum(row["missing"] for row in rows),
            "nothing": [row["variant"].title for row in rows if row["nothing"]],
            "floor": FLOOR_DB,
            "axes_of_points": ", ".join(axis_name(name) for name in sweep.case_axes),
        }

    def _row(self, variant: Variant) -> dict[str, Any]:
        found, points = self.report.verdicts[variant], len(self.result.points_of(variant))
        worst, missing = found["worst_edge"], self.report.missing.get(variant, 0)
        return {
            "variant": variant,
            "counted": counted([finding for finding in self.report.compared if finding.variant == variant]),
            "findings": found,
            "worst_at": ", ".join(f"{worst.get(axis, math.nan):.6g}" for axis in self.result.sweep.case_axes),
            "seconds": found["seconds"] / points if points else math.nan,
            "missing": missing,
            "nothing": variant in self.report.blocked or points == missing,
            "friction_law": str(engine(variant.engine).capabilities.friction_law),
        }


POINT = "figure3"
"""Scenario that shows a transmittance."""


class DeviationsSection(Section):
    """A row a variant that deviates."""

    title = "Deviations and laws"
    template = "deviations"

    @property
    def shown(self) -> bool:
        return bool(self.report.deviations)

    def context(self) -> dict[str, Any]:
        variants = [row["variant"] for row in self.report.deviations]
        commands = {own: f"multibody-xval reproduce {own} {POINT}" for own in variants if has_reproducer(own)}
        return {"rows": self.report.deviations, "failures": self.report.failures, "commands": commands}


UNKNOWN = {"outcome": "", "text": "", "words": "not known"}
"""A cell of a variant that was not run in full."""


class Catalogue(Section):
    """A heat map: a row a variant, a column a scenario."""

    title = "Other scenarios"
    template = "catalogue"
    numbers = "catalogue.csv"

    @property
    def shown(self) -> bool:
        return bool(self.report.catalogue)

    def context(self) -> dict[str, Any]:
        known = self.report.catalogue
        variants = [variant for variant in self.report.errors if any(variant in own for own in known.values())]
        return {
            "scenarios": {name: CATALOGUE[name].question for name in known},
            "rows": [
                (variant, [cell_of(own[variant]) if variant in own else UNKNOWN for own in known.values()])
                for variant in variants
            ],
            "signs": {str(outcome): sign for outcome, sign in SIGNS.items()},
            "numbers": self.numbers,
        }


LONGEST = 10
"""Rows of one variant that the page shows, the largest differences first; files hold all of them."""


class OpenPoints(Section):
    """Everything that does not agree, by variant; points with the same verdict and reason in one row."""

    title = "Points that do not agree"
    template = "open_points"

    def context(self) -> dict[str, Any]:
        shown = []
        for variant in self.result.sweep.variants:
            rows = self._rows(variant)
            if variant.engine == REFERENCE.engine:  # beside itself only what has no number says anything
                rows = [row for row in rows if math.isnan(row["difference"])]
            if rows:
                of = engine(variant.engine)
                known_deviation = of.preset(variant.formulation, variant.preset_name).known_deviation
                deviates = f"Deviates from Coulomb's law: {known_deviation}." if known_deviation else ""
                notes = " ".join(note for note in (of.capabilities.notes, deviates) if note)
                left_out = max(len(rows) - LONGEST, 0)
                shown.append({"title": variant.title, "notes": notes, "rows": rows[:LONGEST], "left_out": left_out})
        return {"variants": shown, "compared": [variant.title for variant in compared_variants(self.result.sweep)]}

    def _rows(self, variant: Variant) -> list[dict[str, Any]]:
        reason = self.report.blocked.get(variant)
        if not self.result.points_of(variant):
            reason = "the dataset holds none of its points"
        if reason is not None:
            missing = Comparison(Verdict.BLOCKED, reason)
            finding = Finding(variant, "", Metric("", "", ""), math.nan, math.nan, missing)
            return [{"places": "every point and every edge", **_judged(finding, (finding,))}]
        groups: dict[tuple[Case, Verdict, str], list[Point]] = defaultdict(list)
        for point in self.result.points_of(variant):
            groups[point.case, point.comparison.verdict, point.comparison.reason].append(point)
        edges = [edge for edge in self.result.edges if edge.variant == variant]
        rows = [{"places": edge.finding.case, **_judged(edge.finding, (edge.finding,))} for edge in edges]
        for (case, _, _), points in groups.items():
            etas = ", ".join(f"{point.frequency_ratio:g}" for point in points)
            rows.append({"places": f"{case}, η_r = {etas}", **_judged(points[0].finding, points[0].findings)})
        return sorted((row for row in rows if row["verdict"] != Verdict.AGREE), key=_order)


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
    """Give deviation, prediction and what is left; of a law without a steady state, that."""
    if not prediction.certified:
        return str(prediction)
    deviation, left, unit = finding.comparison.difference, prediction.difference, finding.metric.unit
    text = (
        f"deviation {deviation:+.4g}, prediction {deviation - left:+.4g}, left {left:+.2g} {unit}, "
        f"allowed {prediction.allowed:.2g}; period {prediction.distance:.2g} U0, allowed {prediction.period_bound:.2g}"
    )
    return text.replace("-", "−")
