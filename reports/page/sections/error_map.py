"""Error maps: where every variant is off, and how far."""

from functools import cached_property
from typing import Any

from reports.data.descriptions import named_axes
from reports.data.error_maps import ErrorMap, error_maps
from reports.drawing.figure import Figure
from reports.figures.error_map import HIGHEST_DB, LOWEST_DB, error_map_figure
from reports.page.section import Section
from scenarios.verdicts.finding import FLOOR_DB
from scenarios.verdicts.truth_error import WRONG_DB

MOST_MAPS = 24
"""Variants whose maps are drawn, those that are farthest from the truth; the files hold the numbers of all."""


class ErrorMaps(Section):
    """A map a variant, the smallest error first."""

    title = "Where the error is"
    template = "error_map"
    numbers = "transmittance.csv"

    @property
    def shown(self) -> bool:
        """Whether there is a map."""
        return bool(self._maps)

    def figures(self) -> list[Figure]:
        """The maps."""
        return [error_map_figure(self._maps[-MOST_MAPS:], named_axes(self.result.sweep, plural=False))]

    def context(self) -> dict[str, Any]:
        """What the text names."""
        return {
            "lowest": LOWEST_DB,
            "highest": HIGHEST_DB,
            "floor": FLOOR_DB,
            "wrong": WRONG_DB,
            "unsteady": any(own.unsteady for own in self._maps),
            "left_out": max(len(self._maps) - MOST_MAPS, 0),
        }

    @cached_property
    def _maps(self) -> list[ErrorMap]:
        return error_maps(self.result, self.report.truths, list(self.report.errors))
