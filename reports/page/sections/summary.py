"""Summary: what is compared and how far every variant is from the truth; and how the numbers were made."""

import math
from typing import Any

from reports.data.descriptions import axis_name, drive_description
from reports.data.options import Installed, SingleOption, by_engine
from reports.data.variants import VariantErrors
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
        """Engines as installed and tuned, where any error is known."""
        figure = installed_figure(self.report.errors)
        return [] if figure is None else [figure]

    def context(self) -> dict[str, Any]:
        """Rows and the definitions that they need."""
        sweep, truths = self.result.sweep, self.result.truths.values()
        shown = [truth for truth in truths if truth.above_floor]
        return {
            "errors": list(self.report.errors.values()),
            "sentences": [sentence(name, own, len(shown)) for name, own in by_engine(self.report.installed).items()],
            "few": self._few(),
            "drawing": chain_drawing(int(max(sweep.axes.get("cells", (sweep.ratios.cells,)))), sweep.excitation.kind),
            "points": len(shown),
            "exact": sum(truth.exact for truth in shown),
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


def sentence(name: str, own: list[Installed], points: int) -> dict[str, Any]:
    """Say of an engine how far it is off as installed, and how far with which options."""
    options = list(dict.fromkeys(option for pair in own for option in pair.options))
    return {
        "engine": name,
        "default": " and ".join(_off(pair.default, points, several=len(own) > 1) for pair in own),
        "tuned": _tuned([pair.tuned for pair in own], points),
        "options": options,
        "decisive": [_decisive(pair.decisive, several=len(own) > 1) for pair in own if pair.decisive is not None],
    }


def _decisive(single: SingleOption, *, several: bool) -> dict[str, str]:
    """Say which one option takes off most of the error, and what it leaves."""
    left = _off(single.errors, single.errors.points + 1, several=several)
    return {"setting": f"{single.option}={single.value}", "left": left}


def _off(own: VariantErrors, points: int, *, several: bool) -> str:
    """Give the largest error, with the formulation where there are several, and the points where they are few."""
    formulation = [own.variant.formulation] if several else []
    few = [f"at {own.known} points"] if own.points < points else []
    notes = ", ".join(formulation + few)
    return f"{own.size:.4g} dB ({notes})" if notes else f"{own.size:.4g} dB"


def _tuned(every: list[VariantErrors], points: int) -> str:
    """Give the largest errors of the formulations; once where all are equal as printed."""
    sizes = {f"{own.size:.4g} dB" for own in every}
    return sizes.pop() if len(sizes) == 1 else " and ".join(_off(own, points, several=True) for own in every)


class Provenance(Section):
    """Versions, options, steps, tolerances, grid."""

    title = "How these numbers were made"
    template = "provenance"

    def context(self) -> dict[str, Any]:
        """The data, as they are, but for the values of the grid: their number and their ends."""
        grids = self.report.provenance["frequency_ratios"].values()
        every = [eta for grid in grids for eta in grid]
        ends = {"first": min(every, default=math.nan), "last": max(every, default=math.nan)}
        return {**self.report.provenance, "grid": {"points": [len(grid) for grid in grids], **ends}}
