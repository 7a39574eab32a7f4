"""Transmittance: the curves, and every variant's difference from the converged reference."""

from dataclasses import dataclass
from typing import Any, ClassVar

from markupsafe import Markup

from engines.contract.tolerances import CONVERGED_TOLERANCE_DB
from reports.figures import LOWEST_DB, overview, panel
from reports.findings import band_definition
from scenarios.agreement import FLOOR_DB
from scenarios.figure3 import Figure3Result


@dataclass(frozen=True)
class Transmittance:
    """The paper's Figure 3 by the reference, then a panel a friction ratio with every variant."""

    result: Figure3Result
    title: ClassVar[str] = "Transmittance"
    template: ClassVar[str] = "transmittance"

    def context(self) -> dict[str, Any]:
        """Figures and what their captions name."""
        return {
            "overview": Markup(overview(self.result)),
            "panels": [
                {"friction_ratio": friction, "svg": Markup(panel(self.result, friction))}
                for friction in self.result.asked.friction_ratios
            ],
            "band": band_definition(self.result),
            "floor": FLOOR_DB,
            "lowest": LOWEST_DB,
            "tolerance": CONVERGED_TOLERANCE_DB,
            "steps": self.result.asked.steps_per_period,
        }
