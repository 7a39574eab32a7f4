"""Work and precision: what accuracy costs in each engine, and how the error falls with the step."""

from typing import Any

from reference_lcp.accuracy.convergence import STICK_SLIP_POINTS
from reports.drawing.figure import Figure
from reports.figures.work_precision import convergence_figure, curves, work_precision_figure
from reports.page.section import Section
from scenarios.studies.work_precision import FINEST_STEPS


class WorkPrecision(Section):
    """Two diagrams and their numbers."""

    title = "Work and precision"
    template = "work_precision"
    numbers = "work_precision.csv"

    @property
    def shown(self) -> bool:
        """Whether any variant was simulated at these steps."""
        return any(point.evaluated for point in self.report.steps or ())

    def figures(self) -> list[Figure]:
        """The diagrams, if any variant was simulated at these steps."""
        steps = self.report.steps or ()
        return (
            [work_precision_figure(self.result.sweep, steps), convergence_figure(self.result.sweep, steps)]
            if curves(steps)
            else []
        )

    def context(self) -> dict[str, Any]:
        """Rows, one a variant and number of steps, and the variants that are left out."""
        steps = self.report.steps or ()
        drawn = curves(steps)
        reasons = {point.variant: point.reason for point in steps if point.reason}
        absent: dict[str, list[str]] = {}
        for variant in self.result.sweep.variants:
            if variant not in drawn:
                evaluated = any(point.variant == variant and point.evaluated for point in steps)
                default = "not all six points have a steady state" if evaluated else "not run at these steps so far"
                absent.setdefault(reasons.get(variant, default), []).append(variant.title)
        return {
            "rows": [point for point in steps if point.evaluated],
            "points": STICK_SLIP_POINTS,
            "steps": sorted({point.steps_per_period for point in steps if point.evaluated}),
            "finest": FINEST_STEPS[0],
            "absent": absent,
        }
