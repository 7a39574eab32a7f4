"""Provenance: what a reader needs to get the same numbers."""

from typing import Any

from reports.page.section import Section


class Provenance(Section):
    """Versions, options, steps, tolerances, grid."""

    title = "How these numbers were made"
    template = "provenance"

    def context(self) -> dict[str, Any]:
        """The data, as they are."""
        return self.report.provenance
