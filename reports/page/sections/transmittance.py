"""Transmittance: the curves, and every variant's difference from the converged reference."""

from typing import Any

from engines.interface.tolerances import CONVERGED_TOLERANCE_DB
from reports.drawing.figure import Figure
from reports.figures.transmittance import LINEAR_DB, LOWEST_DB, overview, panel
from reports.page.section import Section
from scenarios.verdicts.finding import FLOOR_DB
from scenarios.verdicts.steady_case import REFERENCE

MOST_PANELS = 24
"""Cases that the page shows, so that it stays small enough to be sent; the files hold all of them."""


class Transmittance(Section):
    """The paper's Figure 3 by the reference, then a panel a case with every variant."""

    title = "Transmittance"
    template = "transmittance"
    numbers = "transmittance.csv"

    def figures(self) -> list[Figure]:
        """The overview, then the panels."""
        lines = [overview(self.result)] if REFERENCE in self.result.sweep.variants else []
        return [*lines, *(panel(self.result, case) for case in self.result.cases[:MOST_PANELS])]

    def context(self) -> dict[str, Any]:
        """What the captions name."""
        return {
            "panels": min(len(self.result.cases), MOST_PANELS),
            "left_out": max(len(self.result.cases) - MOST_PANELS, 0),
            "over": "P0 / k_c" if self.result.sweep.excitation.kind == "force" else "the base's",
            "floor": FLOOR_DB,
            "lowest": LOWEST_DB,
            "linear": LINEAR_DB,
            "tolerance": CONVERGED_TOLERANCE_DB,
        }
