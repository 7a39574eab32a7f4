"""Summary: what is compared and how far every variant is from the truth; and how the numbers were made."""

import math
from collections.abc import Sequence
from typing import Any

from multibody_xval.engines.interface.registry import engine
from multibody_xval.reports.data.descriptions import axis_name, drive_description
from multibody_xval.reports.data.finding import finding
from multibody_xval.reports.data.options import TITLES, Headline, by_engine
from multibody_xval.reports.figures.chain_drawing import chain_drawing
from multibody_xval.reports.figures.drawing import Drawing
from multibody_xval.reports.figures.errors import installed_figure
from multibody_xval.reports.formatting import fixed, ratio
from multibody_xval.reports.page.section import Section
from multibody_xval.reports.reproducers.recipe import code_lines, has_recipe, recipe_text
from multibody_xval.scenarios.studies.headline import HEADLINE_POINTS, HEADLINE_STEPS
from multibody_xval.scenarios.sweeps.truths import WRONG_DB
from multibody_xval.scenarios.verdicts.finding import FLOOR_DB

LINES_TO_PASTE = 2
"""Lines of a recipe that stand beside its engine; the others are folded."""


class Summary(Section):
    """The finding, a line an engine with what to paste, and the errors of all presets on one axis."""

    title = "Summary"
    template = "summary"
    numbers = "errors.csv"

    def figures(self) -> list[Drawing]:
        figure = installed_figure(self.report.errors, self._where)
        return [] if figure is None else [figure]

    @property
    def _where(self) -> str:
        """Name the points at which errors are compared."""
        if not self.report.headline:
            shown = sum(truth.above_floor for truth in self.result.truths.values())
            return f"the {shown} points of this page above {fixed(FLOOR_DB, 0)} dB"
        return f"{len(HEADLINE_POINTS)} points of the band"

    def context(self) -> dict[str, Any]:
        sweep, truths = self.result.sweep, self.result.truths.values()
        shown = [truth for truth in truths if truth.above_floor]
        chain = sweep.ratios.chain(0.0)
        return {
            "errors": list(self.report.errors.values()),
            "finding": finding(self.report.headlines, self.report.conclusions),
            "engines": {title: (own, _pasted(own)) for title, own in by_engine(self.report.headlines).items()},
            "titles": list(TITLES.values()),
            "status": self.report.status,
            "failures": self.report.failures,
            "where": self._where,
            "steps": HEADLINE_STEPS,
            "headline": [f"({ratio(f)}, {ratio(eta)})" for f, eta in HEADLINE_POINTS] if self.report.headline else [],
            "beside": [own.title for own in self.report.errors if own not in self.report.variants],
            "drawing": chain_drawing(int(max(sweep.axes.get("cells", (sweep.ratios.cells,)))), sweep.excitation.kind),
            "points": len(shown),
            "exact": sum(truth.exact for truth in shown),
            "proven": sum(truth.proven for truth in shown),
            "truth_error": max((truth.error_db for truth in shown), default=math.nan),
            "wrong": WRONG_DB,
            "missing": sum(self.report.missing.values()),
            "floor": FLOOR_DB,
            "axes": [
                (axis_name(name, plural=True), [ratio(value) for value in sweep.axes[name]]) for name in sweep.case_axes
            ],
            "axes_of_points": ", ".join(axis_name(name) for name in sweep.case_axes),
            "complete_by_command": not self.report.recorded,
            "first": sweep.frequency_ratios[0],
            "last": sweep.frequency_ratios[-1],
            "cells": " or ".join(ratio(n) for n in sweep.axes.get("cells", (sweep.ratios.cells,))),
            "drive": drive_description(sweep),
            "mass": float(chain.outer_mass[0]),
            "stiffness": float(chain.chain_stiffness[0]),
        }


def _pasted(rows: Sequence[Headline]) -> dict[str, Any]:
    """Give what to write in one's own model for an engine: lines of its recipe, and the whole of it."""
    name = rows[0].variant.engine
    if not has_recipe(engine(name)):
        return {"name": name, "first": [], "whole": ""}
    return {"name": name, "first": code_lines(name)[:LINES_TO_PASTE], "whole": recipe_text(name)}


class Provenance(Section):
    """Versions, options, steps, tolerances, grid."""

    title = "How these numbers were made"
    template = "provenance"

    def context(self) -> dict[str, Any]:
        grids = self.report.provenance["frequency_ratios"].values()
        every = [eta for grid in grids for eta in grid]
        ends = {"first": min(every, default=math.nan), "last": max(every, default=math.nan)}
        return {**self.report.provenance, "grid": {"points": [len(grid) for grid in grids], **ends}}
