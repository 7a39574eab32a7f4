"""Tables on a terminal: no wider than it is, and 80 columns where there is none."""

import textwrap
from collections.abc import Sequence

from rich import box
from rich.console import Console
from rich.markup import escape
from rich.measure import Measurement
from rich.table import Table

from reference_lcp.visible import visible

READABLE = 20
"""Columns that a column of texts has at least, if its texts are that long: narrower ones are hard to read."""

LONGEST_NAME = 44
"""Columns of a name in the first column; a longer one, with many options, is wrapped."""

UNLIMITED = 100_000
"""Columns of a terminal on which every table fits, to measure it."""


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
    columns = [(heading, [row[number] for row in rows]) for number, heading in enumerate(headings)]
    first, rest = columns[0], columns[1:]
    while True:
        count = next(
            (n for n in range(len(rest), 1, -1) if _width(console, [first, *rest[:n]]) <= console.width),
            min(1, len(rest)),
        )
        console.print(_table([first, *rest[:count]], title))
        rest, title = rest[count:], None
        if not rest:
            return


_Column = tuple[str, list[str]]


def _width(console: Console, columns: Sequence[_Column]) -> int:
    """Give the least width of a table [characters]."""
    unlimited = console.options.update_width(UNLIMITED)
    return Measurement.get(console, unlimited, _table(columns, None)).minimum


def _table(columns: Sequence[_Column], title: str | None) -> Table:
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), title=title, title_justify="left")
    for number, (heading, cells) in enumerate(columns):
        widest = max((len(line) for cell in cells for line in cell.split("\n")), default=0)
        is_text = any(" " in cell for cell in cells) if number else widest > LONGEST_NAME
        if is_text:
            longest = LONGEST_NAME if not number else max(READABLE, _longest_word(heading))
            table.add_column(_plain(heading), min_width=min(widest, longest), overflow="fold")
        else:
            wrapped = textwrap.fill(visible(heading), max(widest, _longest_word(heading)), break_on_hyphens=False)
            table.add_column(escape(wrapped), no_wrap=True)
    for row in zip(*(cells for _, cells in columns), strict=True):
        table.add_row(*map(_plain, row))
    return table


def _longest_word(text: str) -> int:
    return max(map(len, text.split()), default=1)


def _plain(text: str) -> str:
    """Give a text as rich prints it: neither its markup nor characters that control a terminal mean anything."""
    return escape("\n".join(map(visible, text.split("\n"))))
