"""Where the error is, what accuracy costs, and what single options decide."""

from functools import cached_property
from typing import Any

from reference_lcp.studies.against_exact import STICK_SLIP_POINTS
from reports.data.descriptions import named_axes
from reports.drawing.figure import Figure
from reports.figures.errors import (
    HIGHEST_DB,
    LOWEST_DB,
    ErrorMap,
    convergence_figure,
    curves,
    error_map_figure,
    error_maps,
    option_figure,
    work_precision_figure,
)
from reports.page.section import Section
from scenarios.studies.work_precision import FINEST_STEPS
from scenarios.sweeps.truths import WRONG_DB
from scenarios.verdicts.finding import FLOOR_DB

MOST_MAPS = 24
"""Variants whose maps are drawn, those that are farthest from the truth; the files hold the numbers of all."""


class ErrorMaps(Section):
    """A map a variant, the smallest error first."""

    title = "Where the error is"
    template = "error_map"
    numbers = "transmittance.csv"

    @property
    def shown(self) -> bool:
        """Whether there is a map."""
        return bool(self._maps)

    def figures(self) -> list[Figure]:
        """The maps."""
        return [error_map_figure(self._maps[-MOST_MAPS:], named_axes(self.result.sweep, plural=False))]

    def context(self) -> dict[str, Any]:
        """What the text names."""
        return {
            "lowest": LOWEST_DB,
            "highest": HIGHEST_DB,
            "floor": FLOOR_DB,
            "wrong": WRONG_DB,
            "unsteady": any(own.unsteady for own in self._maps),
            "left_out": max(len(self._maps) - MOST_MAPS, 0),
        }

    @cached_property
    def _maps(self) -> list[ErrorMap]:
        return error_maps(self.report.points, self.result.cases, self.report.errors)


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
        return {"groups": groups, "points": len({point.place[1:] for point in self.report.one_option})}
