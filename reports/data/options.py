"""What options decide: the errors of engines as installed, as recommended and tuned."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.data.variants import Errors
from multibody_xval.reports.formatting import MISSING, significant
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE

TITLES = {"default": "as installed", "recommended": "recommended", "tuned": "tuned"}
"""Presets that README, page and terminal compare, and what they are called there."""

UNSTEADY = "unsteady"
"""Stands for an error where fewer than a third of the points have a steady state."""


def is_unsteady(row: Any) -> bool:
    """Whether there are too few steady states for an error."""
    return bool(3 * row.points_known < row.points)


def error_text(row: Any | None) -> str:
    """Give the largest error of a row of `Errors` in two digits [dB]; with a star where points are not known."""
    if row is None or (not row.points_known and row.blocked):
        return MISSING
    if is_unsteady(row):
        return UNSTEADY
    return significant(row.size) + ("*" if row.points_known < row.points else "")


class Headline(NamedTuple):
    """One engine and formulation: its errors to the truth by preset."""

    variant: Variant
    """The tuned one."""
    rows: Mapping[str, Any]
    """Rows of `Errors` by name of the preset, of those in `TITLES`."""

    @property
    def texts(self) -> list[str]:
        """Largest errors [dB] in the order of `TITLES`."""
        return [error_text(self.rows.get(name)) for name in TITLES]

    def size(self, name: str) -> float:
        """Give the largest error with a preset [dB]; NaN where it is not known, or unsteady."""
        row = self.rows.get(name)
        return math.nan if row is None or is_unsteady(row) else float(row.size)

    @property
    def farthest(self) -> float:
        """The largest of them; −1 without any."""
        return max((size for name in TITLES if not math.isnan(size := self.size(name))), default=-1.0)


def headlines(errors: Errors) -> list[Headline]:
    """Give a row an engine and formulation but for the reference, the largest error as installed first."""
    rows: dict[Variant, dict[str, Any]] = {}
    for variant, own in errors.items():
        if variant.engine != REFERENCE.engine and variant.preset_name in TITLES:
            rows.setdefault(variant.tuned, {})[variant.preset_name] = own
    shown = [Headline(variant, own) for variant, own in rows.items()]
    return sorted(shown, key=lambda row: (math.isnan(row.size("default")), -row.farthest))


def by_engine(rows: Sequence[Headline]) -> dict[str, list[Headline]]:
    """Group rows by the title of their engine, joints first."""
    groups: dict[str, list[Headline]] = {}
    for row in rows:
        groups.setdefault(row.variant.capabilities.title, []).append(row)
    return {title: sorted(own, key=lambda row: row.variant.formulation != "joint") for title, own in groups.items()}
