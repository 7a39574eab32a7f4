"""Tables on a terminal: no number is cut off, and no line is wider than the terminal."""

import textwrap
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, TypeVar

from multibody_xval.engines.interface.texts import visible

if TYPE_CHECKING:
    from rich.console import Console

_Item = TypeVar("_Item")

READABLE = 24
"""Columns that a column of texts has at least, if its texts are that long: narrower ones are hard to read."""

SHORT_HEADING = 8
"""Columns of a heading that stands in one line."""

LONGEST_NAME = 44
"""Columns of a name in the first column; a longer one, with many options, is wrapped."""


def tracked(items: Sequence[_Item], unit: str) -> Iterable[_Item]:
    """Give items one after the other, with a bar on a terminal."""
    from rich.console import Console
    from rich.progress import track

    console = Console(stderr=True)
    return track(items, unit, console=console, transient=True, disable=not console.is_terminal)


def print_table(
    headings: Sequence[str],
    rows: Sequence[Sequence[str]],
    *,
    title: str | None = None,
    console: "Console | None" = None,
) -> None:
    """Print a table of texts; columns that do not fit follow in a table below, with the first column again."""
    from rich import box
    from rich.console import Console  # rich is imported once something is shown
    from rich.markup import escape
    from rich.table import Table

    console = console or Console()
    columns = [
        [visible(heading), *("\n".join(map(visible, row[place].split("\n"))) for row in rows)]
        for place, heading in enumerate(headings)
    ]
    sizes = [_widths(column, first=place == 0) for place, column in enumerate(columns)]
    rest, more = list(range(1, len(columns))), True
    while more:
        shown = [0]
        while rest and (len(shown) == 1 or _width([sizes[n] for n in [*shown, rest[0]]]) <= console.width):
            shown.append(rest.pop(0))
        table = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), title_justify="left")
        table.title = None if title is None else escape(visible(title))
        for place, width in zip(shown, _shared([sizes[n] for n in shown], console.width), strict=True):
            heading = textwrap.fill(columns[place][0], width, break_on_hyphens=False)
            table.add_column(escape(heading), width=width, overflow="fold")
        for row in range(len(rows)):
            table.add_row(*(escape(columns[place][row + 1]) for place in shown))
        console.print(table)
        title, more = None, bool(rest)


def _widths(column: Sequence[str], *, first: bool) -> tuple[int, int]:
    """Give the width that a column has at least, and without a limit; numbers and names are not wrapped."""
    heading, *cells = column
    widest = max((len(line) for cell in cells for line in cell.split("\n")), default=0)
    word = len(heading) if len(heading) <= SHORT_HEADING else max(map(len, heading.split()), default=1)
    texts = any(" " in cell for cell in cells)
    return max(word, min(widest, LONGEST_NAME if first else READABLE if texts else widest)), max(widest, word)


def _width(sizes: Sequence[tuple[int, int]]) -> int:
    """Give the least width of a table: each column has a blank on both sides, and one is shared."""
    return sum(least + 2 for least, _ in sizes) + 1


def _shared(sizes: Sequence[tuple[int, int]], width: int) -> list[int]:
    """Share what is left of the width among columns, those that need least first."""
    widths, free = [least for least, _ in sizes], max(width - _width(sizes), 0)
    wrapped = sorted((natural - least, n) for n, (least, natural) in enumerate(sizes) if natural > least)
    for place, (missing, number) in enumerate(wrapped):
        more = min(missing, free // (len(wrapped) - place))
        widths[number] += more
        free -= more
    return widths
