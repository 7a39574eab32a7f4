"""Friction and frequency: where the attenuation band is, and how it moves with friction."""

from typing import Any

from reports.data.descriptions import band_definition
from reports.figures.figure import Figure
from reports.figures.friction_map import HIGHEST_DB, LOWEST_DB, friction_map_figure
from reports.page.section import Section


class FrictionMapSection(Section):
    """The map of the reference, with the contour of the band."""

    title = "Friction and frequency"
    template = "friction_map"

    @property
    def shown(self) -> bool:
        """Whether the map is part of the report."""
        return self.report.friction_map is not None

    def figures(self) -> list[Figure]:
        """The map, if any of its points is known."""
        data = self.report.friction_map
        return [friction_map_figure(data)] if data is not None and data.known else []

    def context(self) -> dict[str, Any]:
        """What the caption names, and how much is missing."""
        data = self.report.friction_map
        return {
            "band": band_definition(self.result.sweep),
            "lowest": LOWEST_DB,
            "highest": HIGHEST_DB,
            "points": 0 if data is None else data.transmittance_db.size,
            "known": 0 if data is None else data.known,
        }
