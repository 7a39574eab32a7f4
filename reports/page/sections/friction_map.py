"""Friction and frequency: where the attenuation band is, and how it moves with friction."""

from typing import Any

from reports.drawing.figure import Figure
from reports.figures.friction_map import HIGHEST_DB, LOWEST_DB, friction_map_figure
from reports.page.section import Section


class FrictionMapSection(Section):
    """The map of the reference, with the contour of the band."""

    title = "Friction and frequency"
    template = "friction_map"

    @property
    def shown(self) -> bool:
        """Whether any point of the map is known."""
        return self.report.friction_map is not None and self.report.friction_map.known > 0

    def figures(self) -> list[Figure]:
        """The map."""
        data = self.report.friction_map
        return [] if data is None else [friction_map_figure(data)]

    def context(self) -> dict[str, Any]:
        """What the caption names, and how much is missing."""
        data = self.report.friction_map
        return {
            "lowest": LOWEST_DB,
            "highest": HIGHEST_DB,
            "points": 0 if data is None else data.transmittance_db.size,
            "known": 0 if data is None else data.known,
        }
