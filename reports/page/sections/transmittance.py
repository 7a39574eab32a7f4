"""Transmittance: the curves, and every variant's difference from the converged reference."""

from typing import Any

from engines.interface.tolerances import CONVERGED_TOLERANCE_DB
from reports.data.findings import band_definition
from reports.figures.figure import Figure
from reports.figures.transmittance import LINEAR_DB, LOWEST_DB, overview, panel
from reports.page.section import Section
from scenarios.verdicts.finding import FLOOR_DB


class Transmittance(Section):
    """The paper's Figure 3 by the reference, then a panel a friction ratio with every variant."""

    title = "Transmittance"
    template = "transmittance"

    def figures(self) -> list[Figure]:
        """The overview, then the panels."""
        return [
            overview(self.result),
            *(panel(self.result, friction) for friction in self.result.asked.friction_ratios),
        ]

    def context(self) -> dict[str, Any]:
        """What the captions name."""
        return {
            "over": "P0 / k_c" if self.result.asked.excitation.kind == "force" else "the base's",
            "band": band_definition(self.result),
            "floor": FLOOR_DB,
            "lowest": LOWEST_DB,
            "linear": LINEAR_DB,
            "tolerance": CONVERGED_TOLERANCE_DB,
        }
