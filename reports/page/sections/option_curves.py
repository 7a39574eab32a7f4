"""Decisive options: how the error of an engine goes with one of its options."""

from typing import Any

from reports.drawing.figure import Figure
from reports.figures.option_curves import option_figure
from reports.page.section import Section


class OptionCurves(Section):
    """A diagram an option in which variants of the report differ, and in nothing else."""

    title = "One option at a time"
    template = "option_curves"
    numbers = "options.csv"

    @property
    def shown(self) -> bool:
        """Whether there is such an option."""
        return bool(self.report.option_curves)

    def figures(self) -> list[Figure]:
        """The diagrams."""
        return [option_figure(number, curve) for number, curve in enumerate(self.report.option_curves, 1)]

    def context(self) -> dict[str, Any]:
        """Nothing beside the diagrams."""
        return {}
