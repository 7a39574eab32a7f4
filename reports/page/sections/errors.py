"""Where the error is, and what accuracy costs."""

from functools import cached_property
from typing import Any

import pandas as pd

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.data.descriptions import named_axes
from multibody_xval.reports.figures.drawing import Drawing
from multibody_xval.reports.figures.errors import (
    HIGHEST_DB,
    LOWEST_DB,
    curves,
    error_map_figure,
    error_maps,
    unsteady,
    work_precision_figures,
)
from multibody_xval.reports.page.section import Section
from multibody_xval.scenarios.studies.work_precision import FINEST_STEPS, StepPoint
from multibody_xval.scenarios.sweeps.truths import WRONG_DB
from multibody_xval.scenarios.verdicts.finding import FLOOR_DB
from reference_lcp.defaults import STICK_SLIP_POINTS

MOST_MAPS = 24
"""Variants whose maps are drawn, those that are farthest from the truth; the files hold the numbers of all."""


class ErrorMaps(Section):
    """A map a variant, the smallest error first."""

    title = "Where the error is"
    template = "error_map"
    numbers = "transmittance.csv"

    @property
    def shown(self) -> bool:
        return bool(self._maps)

    def figures(self) -> list[Drawing]:
        drawn = dict(list(self._maps.items())[-MOST_MAPS:])
        return [error_map_figure(drawn, self._unsteady, named_axes(self.result.sweep, plural=False))]

    def context(self) -> dict[str, Any]:
        return {
            "lowest": LOWEST_DB,
            "highest": HIGHEST_DB,
            "floor": FLOOR_DB,
            "wrong": WRONG_DB,
            "unsteady": bool(self._unsteady["variant"].isin(list(self._maps)).any()),
            "left_out": max(len(self._maps) - MOST_MAPS, 0),
        }

    @cached_property
    def _maps(self) -> dict[Variant, pd.DataFrame]:
        return error_maps(self.report.points, self.result.cases, self.report.errors)

    @property
    def _unsteady(self) -> pd.DataFrame:
        return unsteady(self.report.points)


class WorkPrecision(Section):
    """Three diagrams and their numbers."""

    title = "Work and precision"
    template = "work_precision"
    numbers = "work_precision.csv"

    @property
    def shown(self) -> bool:
        return bool(curves(self._evaluated))

    @property
    def _evaluated(self) -> list[StepPoint]:
        return [point for point in self.report.steps or () if point.evaluated]

    def figures(self) -> list[Drawing]:
        drawn = curves(self.report.steps or ())
        return work_precision_figures(drawn) if drawn else []

    def context(self) -> dict[str, Any]:
        steps = self.report.steps or ()
        drawn = curves(steps)
        reasons = dict.fromkeys(self.result.sweep.variants, "not run at these steps so far")
        reasons |= {point.variant: "not all six points have a steady state" for point in self._evaluated}
        reasons |= {point.variant: point.reason for point in steps if point.reason}
        absent: dict[str, list[str]] = {}
        for variant in self.result.sweep.variants:
            if variant not in drawn:
                absent.setdefault(reasons[variant], []).append(variant.title)
        return {
            "rows": self._evaluated,
            "points": STICK_SLIP_POINTS,
            "steps": sorted({point.steps_per_period for point in self._evaluated}),
            "finest": FINEST_STEPS[0],
            "absent": absent,
        }
