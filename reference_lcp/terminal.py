"""What people see on a terminal: tables, progress, first compilations, and texts of others shown and not obeyed."""

import re
import sys
import textwrap
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from rich.console import Console

_CONTROLS = re.compile(
    "["
    "\x00-\x1f\x7f-\x9f"  # C0 with line feeds and escape sequences, C1
    "\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069"  # the order in which letters are shown, and ends of lines
    "\ud800-\udfff"  # bytes of file names that are no UTF-8
    "\ufffe\uffff"  # no characters; XML refuses them
    "]"
)

READABLE = 24
"""Columns that a column of texts has at least, if its texts are that long: narrower ones are hard to read."""

SHORT_HEADING = 8
"""Columns of a heading that stands in one line."""

LONGEST_NAME = 44
"""Columns of a name in the first column; a longer one, with many options, is wrapped."""

_Item = TypeVar("_Item")

NOTICE = "compiling the solvers for this machine: this takes up to half a minute, once; they are kept for later runs"
"""Said once, before results."""


def visible(text: str) -> str:
    r"""Give a text in one line that no terminal obeys: an escape character becomes the letters ``\x1b``."""
    return _CONTROLS.sub(lambda control: control[0].encode("unicode_escape").decode(), text)


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


def tracked(items: Sequence[_Item], unit: str) -> Iterator[_Item]:
    """Give items one after the other, with a bar on a terminal."""
    with counted(unit, len(items)) as advance:
        for item in items:
            yield item
            advance()


@contextmanager
def counted(unit: str, total: int) -> Iterator[Callable[[], None]]:
    """Show on a terminal how many of so many are done; gives what counts one."""
    from rich.console import Console
    from rich.progress import Progress

    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        bar = progress.add_task(unit, total=total)
        yield lambda: progress.advance(bar)


@cache
def announce_compilation() -> None:
    """Say it in a terminal when the suite has to be compiled, once; commands call this before they compute."""
    if not sys.stderr.isatty():
        return
    from numba.core import event as compiler

    class Notice(compiler.Listener):  # type: ignore[misc]
        said = False

        def on_start(self, event: Any) -> None:
            package = str(event.data["dispatcher"].py_func.__module__).partition(".")[0]
            if not self.said and package in ("reference_lcp", "multibody_xval"):
                self.said = True
                print(NOTICE, file=sys.stderr, flush=True)

        def on_end(self, event: Any) -> None:
            """Nothing is said at the end: results follow."""

    compiler.register("numba:compile", Notice())
