"""Departures: what departs of each variant, what its law says of that, and what is left."""

from typing import Any

from reports.page.section import Section


class DeparturesSection(Section):
    """A row a variant that departs."""

    title = "Departures and laws"
    template = "departures"

    @property
    def shown(self) -> bool:
        """Whether anything departs."""
        return bool(self.report.departures)

    def context(self) -> dict[str, Any]:
        """Rows, and what fails."""
        return {"rows": self.report.departures, "failures": self.report.failures}
