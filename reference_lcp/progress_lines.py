"""Progress without a terminal: a plain line each ten seconds or five percent, with an estimate of what is left."""

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from threading import Event, RLock, Thread
from time import monotonic
from types import TracebackType
from typing import Self, TypeVar

LINE_SECONDS = 10.0
"""Time after which a line is printed, whatever has happened [s]: CI services stop what is silent for long."""

LINE_PART = 0.05
"""Part of the work after which a line is printed."""

LEAST_SECONDS = 1.0
"""Time between lines at least [s]: work of seconds needs none."""

_Item = TypeVar("_Item")


class ProgressLines:
    """Prints to standard error how far a work is, while it is entered.

    Parameters
    ----------
    unit
        What is counted, in the plural.
    clock
        Gives the time [s].
    """

    def __init__(self, unit: str, clock: Callable[[], float] = monotonic):
        self._unit, self._clock = unit, clock
        self._done = self._total = self._known = 0
        self._start = self._printed = clock()
        self._part = 0.0
        self._end, self._lock = Event(), RLock()
        self._thread = Thread(target=self._print_in_time, daemon=True)

    def expect(self, count: int) -> None:
        """Add to the work."""
        with self._lock:
            self._total += count

    def recall(self, count: int) -> None:
        """Take from the work what was known already."""
        with self._lock:
            self._total -= count
            self._known += count

    def advance(self, count: int) -> None:
        """Add to what is done."""
        with self._lock:
            self._done += count
            if self._part_done >= self._part + LINE_PART and self._clock() >= self._printed + LEAST_SECONDS:
                self.print_line()

    def print_line(self) -> None:
        """Print how far it is now."""
        with self._lock:
            self._printed, self._part = self._clock(), self._part_done
            print(self._text(), file=sys.stderr, flush=True)

    @property
    def _part_done(self) -> float:
        return self._done / self._total if self._total > 0 else 0.0

    def _text(self) -> str:
        known = f", {self._known:,} known before" if self._known else ""
        seconds = self._clock() - self._start
        left = f"about {_duration(seconds * (self._total - self._done) / self._done)}" if self._done else "unknown"
        counts = f"{self._done:,} of {self._total:,} {self._unit} ({self._part_done:.0%}){known}"
        return f"{counts}; {_duration(seconds)} so far, left: {left}"

    def _print_in_time(self) -> None:
        while not self._end.wait(max(self._printed + LINE_SECONDS - self._clock(), 0.0)):
            with self._lock:
                if self._clock() >= self._printed + LINE_SECONDS:
                    self.print_line()

    def __enter__(self) -> Self:
        self._start = self._printed = self._clock()
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._end.set()
        self._thread.join()


def _duration(seconds: float) -> str:
    """Give a time as people say it."""
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
