"""Tables on a terminal: no wider than it is, and 80 columns where there is none."""

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from reference_lcp.visible import visible

READABLE = 24
"""Columns that a column of texts has at least, if its texts are that long: narrower ones are hard to read."""

LONGEST_NAME = 44
"""Columns of a name in the first column; a longer one, with many options, is wrapped."""


def print_table(
    headings: Sequence[str], rows: Sequence[Sequence[str]], *, title: str | None = None, console: Console | None = None
) -> None:
    """Print a table of texts; columns that do not fit follow in a table below, with the first column again.

    Numbers and names are never wrapped, texts and headings are, at spaces.

    Parameters
    ----------
    headings
        Of the columns; the first column names the row.
    rows
        Texts, possibly of several lines; what would control a terminal in them is shown.
    title
        Of the table.
    console
        Where it is printed, in its width; standard output without it.
    """
    console = console or Console()
    columns = [_column(heading, [row[number] for row in rows], number) for number, heading in enumerate(headings)]
    first, rest = columns[0], columns[1:]
    while True:
        fitting = [n for n in range(1, len(rest) + 1) if _width([first, *rest[:n]]) <= console.width]
        count = max(fitting, default=min(1, len(rest)))
        console.print(_table([first, *rest[:count]], title, console.width))
        rest, title = rest[count:], None
        if not rest:
            return


@dataclass(frozen=True)
class _Column:
    """A column, with the width [characters] that it has at least, and that it has without a limit."""

    heading: str
    cells: Sequence[str]
    least: int
    natural: int


def _column(heading: str, cells: Sequence[str], number: int) -> _Column:
    """Give a column; numbers and names keep their width, texts are wrapped, and names with many options."""
    heading, cells = visible(heading), ["\n".join(map(visible, cell.split("\n"))) for cell in cells]
    widest = max((len(line) for cell in cells for line in cell.split("\n")), default=0)
    word = max(map(len, heading.split()), default=1)
    if number == 0:
        least = min(widest, LONGEST_NAME)
    else:
        least = min(widest, READABLE) if any(" " in cell for cell in cells) else widest
    return _Column(heading, cells, max(least, word), max(widest, word))


def _width(columns: Sequence[_Column]) -> int:
    """Give the least width of a table: each column has a blank on both sides, and one is shared."""
    return sum(column.least + 2 for column in columns) + 1


def _table(columns: Sequence[_Column], title: str | None, width: int) -> Table:
    """Give a table in which columns of texts share what is left of the width, those that need least first."""
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), title=title, title_justify="left")
    widths = [column.least for column in columns]
    free = width - _width(columns)
    wrapped = sorted(
        (n for n, each in enumerate(columns) if each.natural > each.least), key=lambda n: columns[n].natural - widths[n]
    )
    for place, number in enumerate(wrapped):
        more = min(columns[number].natural - widths[number], max(free, 0) // (len(wrapped) - place))
        widths[number] += more
        free -= more
    for column, own in zip(columns, widths, strict=True):
        heading = textwrap.fill(column.heading, own, break_on_hyphens=False)
        table.add_column(escape(heading), width=own, overflow="fold")
    for row in zip(*(column.cells for column in columns), strict=True):
        table.add_row(*map(escape, row))
    return table
