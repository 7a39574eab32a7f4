"""Summary: what is compared and how far every variant is from the truth; and how the numbers were made."""

import math
from collections.abc import Sequence
from typing import Any

from engines.interface.registry import engine
from reports.data.descriptions import axis_name, drive_description
from reports.data.options import Headline
from reports.drawing.figure import Figure
from reports.figures.chain_drawing import chain_drawing
from reports.figures.errors import installed_figure
from reports.formatting import ratio, significant
from reports.page.section import Section
from reports.reproducers.recipe import has_recipe
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
            "finding": finding(self.report.headlines),
            "rows": [(row, _recipe(row)) for row in self.report.headlines],
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


def finding(rows: Sequence[Headline]) -> str:
    """Say in two sentences how far engines are off as installed, and what is left with options."""
    installed = [row for row in rows if not math.isnan(row.installed)]
    best = [min(row.recommended, row.tuned, key=_or_infinite) for row in rows]
    left = max((size for size in best if not math.isnan(size)), default=math.nan)
    said = []
    if installed:
        worst = max(installed, key=lambda row: row.installed)
        wrong = sum(row.installed >= WRONG_DB for row in installed)
        said.append(
            f"As installed, {wrong} of {len(installed)} engines are wrong by {significant(WRONG_DB)} dB or more; the "
            f"farthest from the exact motion is {worst.variant.title}, by {significant(worst.installed)} dB."
        )
    if not math.isnan(left):
        said.append(f"With options set, none is farther than {significant(left)} dB from the exact motion.")
    return " ".join(said)


def _or_infinite(size: float) -> float:
    return math.inf if math.isnan(size) else size


def _recipe(row: Headline) -> str:
    """Give the command that prints what to paste; empty without a recipe."""
    return f"multibody-xval recipe {row.variant.engine}" if has_recipe(engine(row.variant.engine)) else ""


class Provenance(Section):
    """Versions, options, steps, tolerances, grid."""

    title = "How these numbers were made"
    template = "provenance"

    def context(self) -> dict[str, Any]:
        grids = self.report.provenance["frequency_ratios"].values()
        every = [eta for grid in grids for eta in grid]
        ends = {"first": min(every, default=math.nan), "last": max(every, default=math.nan)}
        return {**self.report.provenance, "grid": {"points": [len(grid) for grid in grids], **ends}}
