"""What is done of a command, on standard error: one bar in a terminal, a line now and then without one."""

import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn

from multibody_xval.scenarios.model import Result, Run, Status

ENDED = (Status.PERIODIC, Status.FINISHED)
"""How runs end that have a result to show."""

LINES = 10
"""Lines of a step at most, where no terminal shows a bar: there is one after each tenth of the runs known by then."""


class Steps:
    """The steps of a command, one after the other, each with its runs; those without any are not shown."""

    def __init__(self, names: Sequence[str], bar: Progress | None):
        self._names, self._bar = names, bar
        self._number, self._total, self._done, self._printed = 0, 0, 0, 0
        self._begin: tuple[float, int] | None = None
        self._task: TaskID | None = None
        self._silent = True

    def begin(self) -> None:
        """Begin the next step."""
        self._number += 1
        self._total = self._done = self._printed = 0
        self._begin = None
        if self._bar is not None and self._task is not None:
            self._bar.remove_task(self._task)
        self._task = None

    def more(self, runs: int) -> None:
        """Add runs to the step: only those that are run, and not what is known."""
        if runs == 0:
            return
        self._total += runs
        if self._bar is None and self._done == 0:
            self._line()
        elif self._bar is not None and self._task is None:
            self._task = self._bar.add_task(self._title, left="")
        self._move()

    def ended(self, results: Mapping[Run, Result]) -> None:
        """Show results that have just come."""
        self._done += len(results)
        if self._begin is None:
            self._begin = time.monotonic(), self._done
        self._first(results)
        if self._bar is None and (self._done - self._printed) * LINES >= self._total:
            self._line()
        self._move()

    def _move(self) -> None:
        if self._bar is not None and self._task is not None:
            self._bar.update(self._task, total=self._total, completed=self._done, left=self._left)

    def _line(self) -> None:
        self._printed = self._done
        print(f"{self._title}: {self._done} of {self._total} runs{self._left}", file=sys.stderr)

    def _first(self, results: Mapping[Run, Result]) -> None:
        """Print the first result of all."""
        done = next((own for own in results.items() if own[1].status in ENDED), None)
        if self._silent and done is not None:
            run, result = done
            self._silent = False
            what = f"{result.level_db:.3f} dB" if result.status is Status.PERIODIC else "simulated to its end"
            text = f"first result: {run.config}, {run.case.title}: {what}"
            print(text, file=sys.stderr) if self._bar is None else self._bar.console.print(text, highlight=False)

    @property
    def _title(self) -> str:
        name = self._names[self._number - 1]
        return f"step {self._number} of {len(self._names)}, {name}" if len(self._names) > 1 else name

    @property
    def _left(self) -> str:
        """Say how long the rest takes by the runs that ended after the first: that one waits for engines to load."""
        begin, first = self._begin or (0.0, self._done)
        rest, since = self._total - self._done, self._done - first
        if not rest or not since:
            return ""
        return f", about {max(1, round(rest * (time.monotonic() - begin) / since))} s left"


@contextmanager
def shown(steps: Sequence[str]) -> Iterator[Steps]:
    """Show the steps of a command, by their names."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield Steps(steps, None)
        return
    columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[left]}")
    with Progress(*columns, console=console, transient=True) as bar:
        yield Steps(steps, bar)
