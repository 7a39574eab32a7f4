"""Departures: what departs of each variant, what its law says of that, and what is left."""

from typing import Any

from reports.page.section import Section
from reports.reproducers.script import has_reproducer

POINT = "figure3"
"""Scenario that shows a transmittance."""


class DeparturesSection(Section):
    """A row a variant that departs."""

    title = "Departures and laws"
    template = "departures"

    @property
    def shown(self) -> bool:
        """Whether anything departs."""
        return bool(self.report.departures)

    def context(self) -> dict[str, Any]:
        """Rows, what fails, and the command that shows a variant's number without the suite, where there is one."""
        variants = [row.variant for row in self.report.departures]
        commands = {own: f"python -m reports reproduce {own} {POINT}" for own in variants if has_reproducer(own)}
        return {"rows": self.report.departures, "failures": self.report.failures, "commands": commands}
