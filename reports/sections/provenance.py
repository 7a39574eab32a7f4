"""Provenance: what a reader needs to get the same numbers."""

from dataclasses import dataclass
from typing import Any, ClassVar


@dataclass(frozen=True)
class Provenance:
    """The data of `reports.provenance.provenance`."""

    data: dict[str, Any]
    title: ClassVar[str] = "How these numbers were made"
    template: ClassVar[str] = "provenance"

    def context(self) -> dict[str, Any]:
        """The data, as they are."""
        return self.data
