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

NOTICEABLE_COST = 1.5
"""Ratio of costs of a step, or one over it, from which on it is printed: other programs on a machine make less."""


def cost_line(ratio: float, what: str = "") -> str:
    """Say what a step costs with the recipe over one with default options; nothing where it is hardly another."""
    noticeable = max(ratio, 1 / ratio) >= NOTICEABLE_COST
    return f"A step takes {ratio:.2g} times as long with the recipe{what}." if noticeable else ""


class Shown:
    """The end of a command: what it prints, and what it writes."""

    def __init__(self, title: str, command: str, points: pd.DataFrame, legend: str = ""):
        from multibody_xval.reports.formatting import versions

        self._ends = versions(points)
        self._parts: list[str | list[str] | pd.DataFrame] = [f"# {title}", f"{legend}\nMade by `{command}`.".strip()]

    def show(self, parts: dict[str, pd.DataFrame | list[str]]) -> None:
        """Print tables and lines under their headings, and keep them for the document."""
        for heading, part in parts.items():
            if len(part):
                print_part(part, heading)
        self.keep(parts)

    def keep(self, parts: dict[str, pd.DataFrame | list[str]]) -> None:
        """Keep tables and lines for the document."""
        for heading, part in parts.items():
            if len(part):
                self._parts += [f"## {heading}"] if heading else []
                self._parts.append(part if isinstance(part, list) else part.map(_text))

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


def print_part(part: pd.DataFrame | list[str], heading: str = "") -> None:
    """Print a table under its heading, or lines after an empty one; none is wider than the terminal."""
    from rich.console import Console

    from multibody_xval.scenarios.table_text import plain, print_table

    if isinstance(part, list):
        Console().print(plain("", *part), highlight=False)
    else:
        print_table(part.map(_text), heading)


def _text(value: object) -> str:
    """Give a value as people read it."""
    if isinstance(value, float):
        return "–" if math.isnan(value) else f"{value:.6g}"
    return visible(str(value))
