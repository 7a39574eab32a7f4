"""Decisive options: what each option does alone, and how the error goes with one of them."""

from typing import Any

from reports.drawing.figure import Figure
from reports.figures.option_curves import option_figure
from reports.page.section import Section


class OptionCurves(Section):
    """Defaults with one option each, and a diagram an option in which variants differ, and in nothing else."""

    title = "One option at a time"
    template = "option_curves"
    numbers = "options.csv"

    @property
    def shown(self) -> bool:
        """Whether any such variant is known."""
        return bool(self.report.option_curves or self.report.single_options)

    def figures(self) -> list[Figure]:
        """The diagrams."""
        return [option_figure(number, curve) for number, curve in enumerate(self.report.option_curves, 1)]

    def context(self) -> dict[str, Any]:
        """Rows of defaults with one option each, by their presets."""
        singles = self.report.single_options
        defaults = dict.fromkeys(single.default.variant for single in singles)
        groups = {variant: [own for own in singles if own.default.variant == variant] for variant in defaults}
        return {"groups": groups, "points": len({point[1:3] for point in self.report.one_option})}
