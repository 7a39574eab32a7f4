"""Versions: what one version of an engine computes otherwise than another."""

from typing import Any

from reports.page.section import Section


class Versions(Section):
    """A row for every two versions of an engine."""

    title = "Versions side by side"
    template = "versions"

    @property
    def shown(self) -> bool:
        """Whether two versions of an engine take part."""
        return bool(self.report.versions)

    def context(self) -> dict[str, Any]:
        """Rows."""
        return {"rows": self.report.versions}
