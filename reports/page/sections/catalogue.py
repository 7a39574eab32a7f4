"""The catalogue: what the store knows of every variant in every scenario."""

from collections.abc import Mapping
from typing import Any

from reports.data.catalogue import SIGNS, Outcome, cell_of
from reports.page.section import Section
from scenarios.catalogue import CATALOGUE


class Catalogue(Section):
    """A heat map: a row a variant, a column a scenario."""

    title = "Other scenarios"
    template = "catalogue"
    numbers = "catalogue.csv"

    @property
    def shown(self) -> bool:
        """Whether any scenario is known."""
        return bool(self.report.catalogue)

    def context(self) -> dict[str, Any]:
        """Names and questions of the scenarios, and the cells of each variant."""
        known = self.report.catalogue
        variants = [variant for variant in self.report.errors if any(variant in own for own in known.values())]
        return {
            "scenarios": {name: CATALOGUE[name].question for name in known},
            "rows": [(variant, [_cell(own.get(variant)) for own in known.values()]) for variant in variants],
            "signs": {str(outcome): sign for outcome, sign in SIGNS.items()},
            "numbers": self.numbers,
        }


def _cell(counts: Mapping[Outcome, int] | None) -> dict[str, str]:
    return cell_of(counts) if counts else {"outcome": "", "text": "", "words": "not known"}
