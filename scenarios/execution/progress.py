"""Progress: a bar a variant or plain lines, each task counted once, with an estimate of the time that remains."""

from collections import Counter
from collections.abc import Callable, Sequence
from time import monotonic
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.markup import escape
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TaskID,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from engines.interface.variant import Variant
from reference_lcp.progress_lines import ProgressLines
from scenarios.execution.evaluator import Evaluator
from scenarios.execution.executor import Executor
from scenarios.execution.storage.store import ResultStore
from scenarios.tasks.result import Result
from scenarios.tasks.task import Task

PACE_SECONDS = 3600.0
"""Time over which the pace is averaged: points of slow engines take minutes."""


class ProgressBars:
    """A bar for each variant, on standard error: computed points, out of all that have to be computed.

    Where standard error is no terminal there are lines for all variants together instead, see `ProgressLines`.
    Results from the store are counted beside the bar: it takes no time, and would spoil the estimate of what remains.

    Parameters
    ----------
    variants
        In the order of the bars.
    clock
        Gives the time [s].
    """

    def __init__(self, variants: Sequence[Variant], clock: Callable[[], float] = monotonic):
        console = Console(stderr=True, force_jupyter=False)
        self._lines = None if console.is_terminal else ProgressLines("points", clock)
        self.progress = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("points, {task.fields[known]} known"),
            TimeElapsedColumn(),
            TimeRemainingColumn(),
            console=console,
            disable=self._lines is not None,
            speed_estimate_period=PACE_SECONDS,
            get_time=clock,
        )
        self._bars: dict[Variant, TaskID] = {}
        for variant in variants:
            self._bar(variant)

    def expect(self, variant: Variant, count: int) -> None:
        """Add to what a variant has to compute."""
        bar = self._bar(variant)
        self.progress.update(bar, total=(self.progress.tasks[bar].total or 0) + count)
        if self._lines is not None:
            self._lines.expect(count)

    def advance(self, variant: Variant, count: int) -> None:
        """Add to what a variant has computed."""
        self.progress.advance(self._bar(variant), count)
        if self._lines is not None:
            self._lines.advance(count)

    def recall(self, variant: Variant, count: int) -> None:
        """Add to what needs no computation, and take it from what has to be computed."""
        bar = self._bar(variant)
        known = self.progress.tasks[bar].fields["known"] + count
        self.progress.update(bar, known=known, total=(self.progress.tasks[bar].total or 0) - count)
        if self._lines is not None:
            self._lines.recall(count)

    def _bar(self, variant: Variant) -> TaskID:
        """Give the bar of a variant; a variant that is added later gets its bar then."""
        if variant not in self._bars:
            self._bars[variant] = self.progress.add_task(escape(variant.title), total=0, known=0)
        return self._bars[variant]

    def __enter__(self) -> Self:
        (self._lines or self.progress).__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        (self._lines or self.progress).__exit__(kind, problem, trace)


class CountingEvaluator(Evaluator):
    """An evaluator that shows how far it is: a bar's total is the tasks that are known so far, each once.

    What is expected is known from the start. Points that are added where a curve needs them, and those that
    refine an edge, are added to the total when they come.

    Parameters
    ----------
    store, executor
        As for every evaluator.
    expected
        What will be run in any case.
    bars
        Where progress is shown.
    retry_blocked
        As for every evaluator.
    """

    def __init__(
        self,
        store: ResultStore,
        executor: Executor,
        expected: Sequence[Task],
        bars: ProgressBars,
        *,
        retry_blocked: bool = False,
    ):
        super().__init__(store, executor, retry_blocked=retry_blocked)
        self._bars = bars
        self._expected: set[Task] = set()
        self.progress, self.recalled = bars.advance, bars.recall
        self._expect(expected)

    def evaluate(self, tasks: Sequence[Task]) -> list[Result]:
        """Give the result of every task, in order."""
        self._expect(self.new_tasks(tasks))
        return super().evaluate(tasks)

    def _expect(self, tasks: Sequence[Task]) -> None:
        """Raise the totals by the tasks that were not expected so far."""
        extra = [task for task in dict.fromkeys(tasks) if task not in self._expected]
        self._expected.update(extra)
        for variant, count in Counter(task.variant for task in extra).items():
            self._bars.expect(variant, count)
