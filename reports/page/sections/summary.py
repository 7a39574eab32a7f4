"""Summary: what is compared and how far every variant is from the truth; and how the numbers were made."""

import math
from typing import Any

from reports.data.descriptions import axis_name, drive_description
from reports.data.options import sentences
from reports.drawing.figure import Figure
from reports.figures.chain_drawing import chain_drawing
from reports.figures.errors import installed_figure
from reports.formatting import ratio
from reports.page.section import Section
from scenarios.sweeps.truths import WRONG_DB
from scenarios.verdicts.finding import FLOOR_DB


class Summary(Section):
    """One row a variant, the smallest error first."""

    title = "Summary"
    template = "summary"
    numbers = "errors.csv"

    def figures(self) -> list[Figure]:
        figure = installed_figure(self.report.errors)
        return [] if figure is None else [figure]

    def context(self) -> dict[str, Any]:
        sweep, truths = self.result.sweep, self.result.truths.values()
        shown = [truth for truth in truths if truth.above_floor]
        chain = sweep.ratios.chain(0.0)
        return {
            "errors": list(self.report.errors.values()),
            "sentences": sentences(self.report.errors, self.report.single_options, len(shown)),
            "few": self._few(),
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
            "hertz": f"{chain.resonator_frequency / (2 * math.pi):.2g}" if self.report.scale else "",
        }

    def _few(self) -> dict[str, Any] | None:
        """Name the variants that are compared at a few points only, and their points; ``None`` without any."""
        beside = self.report.beside
        if not beside:
            return None
        places = [f"({point.case.numbers}, {ratio(point.frequency_ratio)})" for point in beside]
        return {
            "variants": list(dict.fromkeys(point.variant.title for point in beside)),
            "points": list(dict.fromkeys(places)),
        }


class Provenance(Section):
    """Versions, options, steps, tolerances, grid."""

    title = "How these numbers were made"
    template = "provenance"

    def context(self) -> dict[str, Any]:
        grids = self.report.provenance["frequency_ratios"].values()
        every = [eta for grid in grids for eta in grid]
        ends = {"first": min(every, default=math.nan), "last": max(every, default=math.nan)}
        return {**self.report.provenance, "grid": {"points": [len(grid) for grid in grids], **ends}}
