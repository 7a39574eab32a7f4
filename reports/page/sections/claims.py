"""What the paper claims, and what each engine would conclude."""

import math
from typing import Any

from multibody_xval.reports.page.section import Section
from multibody_xval.scenarios.studies.claims import (
    LOCKED,
    MOVED,
    RANGE,
    RESONATOR,
    STATED,
    Band,
    called,
    edge_text,
    sentence,
)
from multibody_xval.scenarios.studies.figure3 import FRICTION_RATIOS


class Claims(Section):
    """The answers of the reference with their numbers, then a row and a sentence a variant."""

    title = "The paper’s claims"
    template = "claims"

    @property
    def shown(self) -> bool:
        return bool(self.report.conclusions)

    def context(self) -> dict[str, Any]:
        reference = self.report.conclusions[0]
        return {
            "stated": STATED,
            "reference": reference.claims,
            "bands": {friction: _shown(band) for friction, band in reference.bands.items()},
            "frictions": FRICTION_RATIOS,
            "rows": [
                {
                    "name": called(own.variant),
                    "answers": own.claims,
                    "edges": [edge_text(own.bands[f].lower) if f in own.bands else "–" for f in FRICTION_RATIOS],
                    "sentence": sentence(own, reference),
                }
                for own in self.report.conclusions
            ],
            "range": RANGE,
            "resonator": RESONATOR,
            "locked": LOCKED,
            "moved": MOVED,
        }


def _shown(band: Band) -> dict[str, Any]:
    """Give the numbers of a band as the page prints them."""
    upper = f"none up to {band.last:g}" if math.isinf(band.upper) else edge_text(band.upper)
    return {"lower": edge_text(band.lower), "upper": upper, "share": 100 * band.share, "stuck": band.stuck}
