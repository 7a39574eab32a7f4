"""Progress bars: one a variant, each question counted once, with an estimate of the time that remains."""

import time
from collections import Counter
from collections.abc import Sequence
from datetime import timedelta
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    TaskID,
    TextColumn,
    TimeElapsedColumn,
)
from rich.progress import Task as ProgressTask
from rich.text import Text

from engines.interface.variant import Variant
from scenarios.execution.evaluator import Evaluator
from scenarios.execution.local_processes import Executor
from scenarios.execution.store import ResultStore
from scenarios.tasks.result import Result
from scenarios.tasks.task import Task


class Pace:
    """How fast points are computed, from those of this run alone: what a store knew takes no time.

    Parameters
    ----------
    begin
        When the first of them was begun [s].
    """

    def __init__(self, begin: float):
        self._begin = begin
        self._last = begin
        self._computed = 0

    def add(self, count: int, now: float) -> None:
        """Note that so many points have been computed by `now` [s]."""
        self._computed += count
        self._last = now

    def remaining(self, points: int) -> float | None:
        """Seconds that so many more points will take at this pace; ``None`` before the first one is there."""
        return points * (self._last - self._begin) / self._computed if self._computed else None


class _Remaining(ProgressColumn):
    """The estimate, such as ``0:01:23 left``."""

    def render(self, task: ProgressTask) -> Text:
        """Give the estimate of one bar."""
        pace: Pace | None = task.fields.get("pace")
        seconds = None if pace is None or task.finished else pace.remaining(int((task.total or 0) - task.completed))
        return Text("" if seconds is None else f"{timedelta(seconds=round(seconds))} left")


class Bars:
    """A bar for each variant of a question, on standard error.

    Parameters
    ----------
    variants
        In the order of the bars.
    """

    def __init__(self, variants: Sequence[Variant]):
        self._bars = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("points"),
            TimeElapsedColumn(),
            _Remaining(),
            console=Console(stderr=True),
        )
        self._paces: dict[Variant, Pace] = {}
        self._last = time.monotonic()
        self._tasks: dict[Variant, TaskID] = {v: self._bars.add_task(v.title, total=0) for v in variants}

    def expect(self, variant: Variant, count: int) -> None:
        """Add to what a variant has to answer."""
        task = self._task(variant)
        self._bars.update(task, total=(self._bars.tasks[task].total or 0) + count)

    def advance(self, variant: Variant, count: int) -> None:
        """Add to what a variant has computed."""
        now = time.monotonic()
        if variant not in self._paces:  # variants are asked one after the other: it began when the last one came
            self._paces[variant] = Pace(self._last)
        self._paces[variant].add(count, now)
        self._last = now
        self._bars.update(self._task(variant), advance=count, pace=self._paces[variant])

    def recall(self, variant: Variant, count: int) -> None:
        """Add to what a variant has answered without a computation."""
        self._bars.advance(self._task(variant), count)
        self._last = time.monotonic()

    def _task(self, variant: Variant) -> TaskID:
        """Give the bar of a variant; one that is asked for the sake of others gets its own when it is."""
        if variant not in self._tasks:
            self._tasks[variant] = self._bars.add_task(variant.title, total=0)
        return self._tasks[variant]

    def __enter__(self) -> Self:
        self._bars.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bars.stop()


class CountingEvaluator(Evaluator):
    """An evaluator that shows how far it is: a bar's total is what is known to be asked, each question once.

    What is expected is known from the start. Points that are added where a curve needs them, and those that
    refine an edge, are added to the total when they are asked.

    Parameters
    ----------
    store, crew
        As for every evaluator.
    expected
        What will be asked in any case.
    bars
        Where progress is shown.
    """

    def __init__(self, store: ResultStore, executor: Executor, expected: Sequence[Task], bars: Bars):
        super().__init__(store, executor)
        self._bars = bars
        self._expected: set[Task] = set()
        self.progress, self.recalled = bars.advance, bars.recall
        self._expect(expected)

    def evaluate(self, questions: Sequence[Task]) -> list[Result]:
        """Answer all questions, in order."""
        self._expect(self.unanswered(questions))
        return super().evaluate(questions)

    def _expect(self, questions: Sequence[Task]) -> None:
        """Raise the totals by the questions that were not expected so far."""
        extra = [question for question in questions if question not in self._expected]
        self._expected.update(extra)
        for variant, count in Counter(question.variant for question in extra).items():
            self._bars.expect(variant, count)
