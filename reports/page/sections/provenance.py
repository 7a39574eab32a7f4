"""Provenance: what a reader needs to get the same numbers."""

import math
from typing import Any

from reports.page.section import Section


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
