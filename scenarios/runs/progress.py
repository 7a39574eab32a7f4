"""Progress: a bar a variant or plain lines, each task counted once, with an estimate of the time that remains."""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from time import monotonic
from types import TracebackType
from typing import Any, Self

from rich.console import Console, RenderableType
from rich.markup import escape
from rich.progress import (
    BarColumn,
    Progress,
    TaskID,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.progress import Task as RichTask
from rich.text import Text

from engines.interface.variant import Variant
from reference_lcp.terminal import LINE_SECONDS, ProgressLines
from scenarios.runs.evaluator import Evaluator
from scenarios.runs.executor import Executor
from scenarios.runs.result import Result
from scenarios.runs.store import ResultStore
from scenarios.runs.task import Task

PACE_SECONDS = 3600.0
"""Time over which the pace is averaged: points of slow engines take minutes."""


class _StagedProgress(Progress):
    """Bars below the name of what is being done."""

    stage = ""

    def get_renderables(self) -> Iterable[RenderableType]:
        """Give the name and the bars."""
        if self.stage:
            yield Text(self.stage)
        yield from super().get_renderables()


class _Remaining(TimeRemainingColumn):
    """The time that remains, but where the total has just grown."""

    def render(self, task: RichTask) -> Text:
        """Give the time as text."""
        grows = task.get_time() < task.fields["grew"] + LINE_SECONDS
        return Text("-:--:--", style="progress.remaining") if grows else super().render(task)


class ProgressBars:
    """A bar for each variant, on standard error: points that are known, out of all that are wanted.

    Where standard error is no terminal there are lines for all variants together instead, see `ProgressLines`.
    What remains is estimated from computed points alone: to look results up takes no time.
    """

    def __init__(self, variants: Sequence[Variant], clock: Callable[[], float] = monotonic):
        console = Console(stderr=True, force_jupyter=False)
        self._lines = None if console.is_terminal else ProgressLines("points", clock)
        self.progress = _StagedProgress(
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.fields[counts]}"),
            TimeElapsedColumn(),
            _Remaining(),
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
        begun = self._progress_of(bar).completed or self._progress_of(bar).fields["known"]
        self._update(bar, count, grew=self.progress.get_time() if begun else -math.inf)
        if self._lines is not None:
            self._lines.expect(count)

    def advance(self, variant: Variant, count: int) -> None:
        """Add to what a variant has computed."""
        bar = self._bar(variant)
        self.progress.advance(bar, count)
        self._update(bar)
        if self._lines is not None:
            self._lines.advance(count)

    def recall(self, variant: Variant, count: int) -> None:
        """Add to what needs no computation, and take it from what has to be computed."""
        bar = self._bar(variant)
        self._update(bar, -count, known=self._progress_of(bar).fields["known"] + count)
        if self._lines is not None:
            self._lines.recall(count)

    def stage(self, name: str) -> None:
        """Name what is being done."""
        self.progress.stage = name
        if self._lines is not None:
            self._lines.stage(name)

    def _progress_of(self, bar: TaskID) -> RichTask:
        return self.progress.tasks[bar]

    def _update(self, bar: TaskID, more: int = 0, **fields: Any) -> None:
        """Change the total and fields of a bar; points that are known count on both sides."""
        own = self._progress_of(bar)
        total, known = (own.total or 0) + more, fields.get("known", own.fields["known"])
        counts = f"{own.completed + known:,.0f}/{total + known:,.0f} points, {known} known"
        self.progress.update(bar, total=total, counts=counts, **fields)

    def _bar(self, variant: Variant) -> TaskID:
        """Give the bar of a variant; a variant that is added later gets its bar then."""
        if variant not in self._bars:
            self._bars[variant] = self.progress.add_task(
                escape(variant.title), total=0, known=0, grew=-math.inf, counts=""
            )
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
        self._counted: set[Task] = set()
        self.progress, self.recalled = self._advance, self._recall
        self.stage = bars.stage
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

    def _advance(self, tasks: Sequence[Task]) -> None:
        self._bars.advance(tasks[0].variant, self._count(tasks))

    def _recall(self, tasks: Sequence[Task]) -> None:
        self._bars.recall(tasks[0].variant, self._count(tasks))

    def _count(self, tasks: Sequence[Task]) -> int:
        """Give how many of the tasks are not counted yet; those that nobody expected by name come once."""
        new = [task for task in tasks if task not in self._counted]
        self._counted.update(task for task in new if task in self._expected)
        return len(new)
