"""Work and precision: what accuracy costs in each engine, and how the error falls with the step."""

from typing import Any

from reference_lcp.accuracy.convergence import STICK_SLIP_POINTS
from reports.figures.figure import Figure
from reports.figures.work_precision import convergence, curves, work_precision
from reports.page.section import Section
from scenarios.studies.accuracy import ORDER_STEPS


class WorkPrecision(Section):
    """Two diagrams and their numbers."""

    title = "Work and precision"
    template = "work_precision"

    @property
    def shown(self) -> bool:
        """Whether steps are part of the report."""
        return self.report.steps is not None

    def figures(self) -> list[Figure]:
        """The diagrams, if any variant was simulated at these steps."""
        steps = self.report.steps or ()
        return (
            [work_precision(self.result.sweep, steps), convergence(self.result.sweep, steps)] if curves(steps) else []
        )

    def context(self) -> dict[str, Any]:
        """Rows, one a variant and number of steps, and who is left out."""
        steps = self.report.steps or ()
        drawn = curves(steps)
        reasons = {point.variant: point.reason for point in steps if point.reason}
        absent: dict[str, list[str]] = {}
        for variant in self.result.sweep.variants:
            if variant not in drawn:
                answered = any(point.variant == variant and point.answered for point in steps)
                usual = (
                    "not all six points are answered with a steady state"
                    if answered
                    else "not asked at these steps so far"
                )
                absent.setdefault(reasons.get(variant, usual), []).append(variant.title)
        return {
            "rows": [point for point in steps if point.answered],
            "points": STICK_SLIP_POINTS,
            "steps": ORDER_STEPS,
            "absent": absent,
        }
