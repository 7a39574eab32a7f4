"""What a measurement prints, and what it writes: tables and lines under headings."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from multibody_xval.engines.interface.texts import visible
from multibody_xval.scenarios.output_files import write_whole

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


class Shown:
    """The end of a command: what it prints, and what it writes."""

    def __init__(self, title: str, command: str, points: pd.DataFrame, legend: str = ""):
        from multibody_xval.reports.formatting import versions

        self._ends = versions(points)
        self._parts: list[str | list[str] | pd.DataFrame] = [f"# {title}", f"{legend}\nMade by `{command}`.".strip()]

    def show(self, parts: dict[str, pd.DataFrame | list[str]]) -> None:
        """Print tables and lines under their headings."""
        from multibody_xval.scenarios.table_text import print_table

        for heading, part in parts.items():
            if not len(part):
                continue
            self._parts += [f"## {heading}"] if heading else []
            if isinstance(part, list):
                print("\n".join(map(visible, ["", *part])))
                self._parts.append(part)
            else:
                texts = part.map(_text)
                print_table(texts, heading)
                self._parts.append(texts)

    def write(self, outs: Sequence[Path], numbers: pd.DataFrame, figure: Callable[[], Figure] | None = None) -> None:
        """Write what was shown as Markdown, every number as CSV, and the figure."""
        from multibody_xval.reports.document import document
        from multibody_xval.reports.figures.studies import figure_file
        from multibody_xval.scenarios.table_text import csv_text

        for out in outs:
            if out.suffix == ".md":
                write_whole(out, document([*self._parts, self._ends]))
            elif out.suffix == ".csv":
                write_whole(out, csv_text(numbers))
            elif figure is not None:
                write_whole(out, figure_file(figure(), out.suffix[1:]))


def _text(value: object) -> str:
    """Give a value as people read it."""
    if isinstance(value, float):
        return "–" if math.isnan(value) else f"{value:.6g}"
    return visible(str(value))
