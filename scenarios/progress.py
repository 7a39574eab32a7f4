"""What is done of a command, on standard error: one bar in a terminal, a line now and then without one."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from multibody_xval.scenarios.model import Result, Run
from multibody_xval.scenarios.pool import Ended

STEPS = 10
"""Lines at most, where no terminal shows a bar."""


@contextmanager
def shown(what: str, total: int) -> Iterator[Ended]:
    """Show how many runs are done; gives what takes their results."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield _Lines(what, total)
        return
    columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn()
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(what, total=total)
        yield lambda results: bar.advance(task, len(results))


class _Lines:
    """Prints a line each tenth of the runs."""

    def __init__(self, what: str, total: int):
        self._what, self._total, self._done, self._printed = what, total, 0, 0

    def __call__(self, results: dict[Run, Result]) -> None:
        self._done += len(results)
        if self._done * STEPS >= (self._printed + 1) * self._total:
            self._printed = self._done * STEPS // self._total
            print(f"{self._what}: {self._done} of {self._total} runs", file=sys.stderr)
