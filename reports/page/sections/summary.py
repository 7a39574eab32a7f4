"""Summary: what is compared, and how far every variant is from the truth."""

import math
from typing import Any

from reports.data.descriptions import axis_name, drive_description
from reports.formatting import ratio
from reports.page.section import Section
from scenarios.verdicts.finding import FLOOR_DB
from scenarios.verdicts.truth import WRONG_DB


class Summary(Section):
    """One row a variant, the smallest error first."""

    title = "Summary"
    template = "summary"

    def context(self) -> dict[str, Any]:
        """Rows and the definitions that they need."""
        sweep, truths = self.result.sweep, self.report.truths.values()
        shown = [truth for truth in truths if truth.above_floor]
        return {
            "errors": list(self.report.errors.values()),
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
