"""The catalogue: what the store knows of every variant in every scenario."""

from collections.abc import Mapping
from typing import Any

from reports.data.catalogue import Outcome
from reports.page.section import Section
from scenarios.catalogue import CATALOGUE

SIGNS = {
    Outcome.UNEXPLAINED: "✗", Outcome.PREDICTED: "≈", Outcome.UNDECIDED: "?", Outcome.BLOCKED: "–", Outcome.AGREES: "✓",
}  # fmt: skip
"""What a cell shows beside its colour."""


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
            "rows": [(variant, [_cell(own.get(variant, {})) for own in known.values()]) for variant in variants],
            "signs": {str(outcome): sign for outcome, sign in SIGNS.items()},
            "numbers": self.numbers,
        }


def _cell(counts: Mapping[Outcome, int]) -> dict[str, str]:
    """Give the sign of the worst outcome, with how many numbers have it where not all do, and all in words."""
    if not counts:
        return {"outcome": "", "text": "", "words": "not known"}
    worst = next(iter(counts))
    number = "" if len(counts) == 1 else f" {counts[worst]}"
    return {
        "outcome": str(worst).replace(" ", "-"),
        "text": SIGNS[worst] + number,
        "words": ", ".join(f"{count} {outcome}" for outcome, count in counts.items()),
    }
