"""What people see on a terminal: tables, progress, first compilations, and texts of others shown and not obeyed."""

import math
import re
import sys
import textwrap
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from threading import Event, RLock, Thread, Timer
from time import monotonic
from typing import TYPE_CHECKING, Any, Self, TypeVar

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

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

LINE_SECONDS = 10.0
"""Time after which a line is printed, whatever has happened [s], and after which work that has grown is estimated."""

LINE_PART = 0.05
"""Part of the work after which a line is printed."""

SILENT_SECONDS = 5.0
"""Time that a command may take without a word [s]."""

LEAST_SECONDS = 1.0
"""Time between lines at least [s]: work of seconds needs none."""

_Item = TypeVar("_Item")

PACKAGES = ("reference_lcp", "multibody_xval")
"""What the suite imports of itself."""

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
    from rich.console import Console  # rich is imported once something is shown

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
    word = len(heading) if len(heading) <= SHORT_HEADING else max(map(len, heading.split()), default=1)
    texts = any(" " in cell for cell in cells)
    least = min(widest, LONGEST_NAME if number == 0 else READABLE if texts else widest)
    return _Column(heading, cells, max(least, word), max(widest, word))


def _width(columns: Sequence[_Column]) -> int:
    """Give the least width of a table: each column has a blank on both sides, and one is shared."""
    return sum(column.least + 2 for column in columns) + 1


def _table(columns: Sequence[_Column], title: str | None, width: int) -> "Table":
    """Give a table in which columns of texts share what is left of the width, those that need least first."""
    from rich import box
    from rich.markup import escape
    from rich.table import Table

    shown = None if title is None else escape(visible(title))
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), title=shown, title_justify="left")
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


class ProgressLines:
    """Prints to standard error how many units of a work are done, while it is entered."""

    def __init__(self, unit: str, clock: Callable[[], float] = monotonic):
        self._unit, self._clock = unit, clock
        self._computed = self._total = self._known = 0
        self._stage, self._grew = "", -math.inf
        self._start = self._printed = clock()
        self._part = 0.0
        self._end, self._lock = Event(), RLock()
        self._thread = Thread(target=self._print_in_time, daemon=True)

    def expect(self, count: int) -> None:
        """Add to the work."""
        with self._lock:
            self._total += count
            if self._computed + self._known:
                self._grew = self._clock()

    def recall(self, count: int) -> None:
        """Add to what is done what was known already."""
        with self._lock:
            self._known += count

    def advance(self, count: int) -> None:
        """Add to what is done."""
        with self._lock:
            self._computed += count
            if self._part_done >= self._part + LINE_PART and self._clock() >= self._printed + LEAST_SECONDS:
                self.print_line()

    def stage(self, name: str) -> None:
        """Name what is being done."""
        with self._lock:
            self._stage = name

    def print_line(self) -> None:
        """Print how far it is now."""
        with self._lock:
            self._printed, self._part = self._clock(), self._part_done
            print(self._text(), file=sys.stderr, flush=True)

    @property
    def _part_done(self) -> float:
        return (self._computed + self._known) / self._total if self._total > 0 else 0.0

    def _text(self) -> str:
        done, seconds = self._computed + self._known, self._clock() - self._start
        left = self._total - done
        known = f", {self._known:,} of them known before" if self._known else ""
        counts = f"{done:,} of {self._total:,} {self._unit} ({self._part_done:.0%}){known}"
        if left == 0:
            estimate = ""
        elif not self._computed or self._clock() < self._grew + LINE_SECONDS:
            estimate = ", left: unknown"
        else:
            estimate = f", left: about {_duration(seconds * left / self._computed)}"
        return f"{self._stage}{': ' if self._stage else ''}{counts}; {_duration(seconds)} so far{estimate}"

    def _print_in_time(self) -> None:
        while not self._end.wait(max(self._printed + LINE_SECONDS - self._clock(), 0.0)):
            with self._lock:
                if self._clock() >= self._printed + LINE_SECONDS:
                    self.print_line()

    def __enter__(self) -> Self:
        self._start = self._printed = self._clock()
        self._thread.start()
        return self

    def __exit__(self, *_problem: object) -> None:
        self._end.set()
        self._thread.join()


@contextmanager
def said_if_long(line: str) -> Iterator[None]:
    """Print a line to standard error if what is done takes longer than `SILENT_SECONDS`."""
    timer = Timer(SILENT_SECONDS, lambda: print(line, file=sys.stderr, flush=True))
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()


class SearchLines:
    """Prints to standard error every `LINE_SECONDS` how far a search is: a watcher, see `reference_lcp.deadline`."""

    def __init__(self, clock: Callable[[], float] = monotonic):
        self._clock, self._what, self._count = clock, "", 0
        self._began = self._printed = clock()

    def __call__(self, what: str, done: int, most: int) -> None:
        """Hear of a period, and print a line if the last one is old."""
        now = self._clock()
        if what != self._what or done <= self._count:
            self._began = now if self._what else self._began
        self._what, self._count = what, done
        if now >= self._printed + LINE_SECONDS:
            self._printed = now
            seconds = now - self._began
            every = _duration(seconds * most / done)
            print(
                f"{what}: {done} of at most {most} periods; {_duration(seconds)} so far, all take about {every}",
                file=sys.stderr, flush=True,
            )  # fmt: skip


def _duration(seconds: float) -> str:
    if seconds < 90:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 90 else f"{minutes // 60} h {minutes % 60:02d} min"


def tracked(items: Sequence[_Item], unit: str) -> Iterator[_Item]:
    """Give items one after the other, with a bar on a terminal and lines elsewhere."""
    with counted(unit, len(items)) as advance:
        for item in items:
            yield item
            advance()


@contextmanager
def counted(unit: str, total: int) -> Iterator[Callable[[], None]]:
    """Show how many of so many are done, with a bar on a terminal and lines elsewhere; gives what counts one."""
    from rich.console import Console
    from rich.progress import Progress

    console = Console(stderr=True)
    if console.is_terminal:
        with Progress(console=console, transient=True) as progress:
            bar = progress.add_task(unit, total=total)
            yield lambda: progress.advance(bar)
        return
    with ProgressLines(unit) as lines:
        lines.expect(total)
        yield lambda: lines.advance(1)


@cache
def announce_compilation() -> None:
    """Say it in a terminal when the suite has to be compiled, once; commands call this before they compute."""
    if not sys.stderr.isatty():
        return
    from numba.core import event as compiler

    class Notice(compiler.Listener):  # type: ignore[misc]
        def on_start(self, event: Any) -> None:
            if str(event.data["dispatcher"].py_func.__module__).partition(".")[0] in PACKAGES:
                say_in_terminal(NOTICE)

        def on_end(self, event: Any) -> None:
            """Nothing is said at the end: results follow."""

    compiler.register("numba:compile", Notice())


@cache
def say_in_terminal(line: str) -> None:
    """Print a line to standard error if that is a terminal, once a process."""
    if sys.stderr.isatty():
        print(visible(line), file=sys.stderr, flush=True)
