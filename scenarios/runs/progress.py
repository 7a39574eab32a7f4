"""Progress: a bar a variant or plain lines, with an estimate of the time that remains."""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from time import monotonic
from typing import Any, Self

from rich.console import Console, RenderableType
from rich.markup import escape
from rich.progress import BarColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.progress import Progress as RichProgress
from rich.progress import Task as RichTask
from rich.text import Text

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.evaluator import Progress
from multibody_xval.scenarios.runs.task import Task
from reference_lcp.terminal import LINE_SECONDS, ProgressLines

PACE_SECONDS = 3600.0
"""Time over which the pace is averaged: points of slow engines take minutes."""


class _StagedProgress(RichProgress):
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


class ProgressBars(Progress):
    """A bar for each variant, on standard error: points that are known, out of all that are wanted, each once.

    Tasks that are `expected` are known from the start. Points that are added where a curve needs them, and those that
    refine an edge, are added to the total when they come. Where standard error is no terminal there are lines for all
    variants together instead, see `ProgressLines`. What remains is estimated from computed points alone: to look
    results up takes no time.
    """

    def __init__(
        self, variants: Sequence[Variant], expected: Sequence[Task] = (), clock: Callable[[], float] = monotonic
    ):
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
        self._bars: dict[Variant, RichTask] = {}
        for variant in variants:
            self._bar(variant)
        self._expected: set[Task] = set()
        self._counted: set[Task] = set()
        self.expect(expected)

    def expect(self, tasks: Sequence[Task]) -> None:
        """Raise the totals by the tasks that were not expected so far."""
        new = [task for task in dict.fromkeys(tasks) if task not in self._expected]
        self._expected.update(new)
        for variant, count in Counter(task.variant for task in new).items():
            self.expect_points(variant, count)

    def expect_points(self, variant: Variant, count: int) -> None:
        """Raise the total of a variant by so many tasks, whichever they are."""
        bar = self._bar(variant)
        self._update(bar, count, grew=bar.get_time() if bar.completed or bar.fields["known"] else -math.inf)
        if self._lines is not None:
            self._lines.expect(count)

    def advance(self, tasks: Sequence[Task]) -> None:
        """Add to what their variant has computed."""
        bar, count = self._bar(tasks[0].variant), self._new(tasks)
        self.progress.advance(bar.id, count)
        self._update(bar)
        if self._lines is not None:
            self._lines.advance(count)

    def recall(self, tasks: Sequence[Task]) -> None:
        """Add to what needs no computation, and take it from what has to be computed."""
        bar, count = self._bar(tasks[0].variant), self._new(tasks)
        self._update(bar, -count, known=bar.fields["known"] + count)
        if self._lines is not None:
            self._lines.recall(count)

    def stage(self, name: str) -> None:
        """Name what is being done."""
        self.progress.stage = name
        if self._lines is not None:
            self._lines.stage(name)

    def _new(self, tasks: Sequence[Task]) -> int:
        """Give how many of the tasks are not counted yet; those that nobody expected by name come once."""
        new = [task for task in tasks if task not in self._counted]
        self._counted.update(task for task in new if task in self._expected)
        return len(new)

    def _update(self, bar: RichTask, more: int = 0, **fields: Any) -> None:
        """Change the total and fields of a bar; points that are known count on both sides."""
        total, known = (bar.total or 0) + more, fields.get("known", bar.fields["known"])
        counts = f"{bar.completed + known:,.0f}/{total + known:,.0f} points, {known} known"
        self.progress.update(bar.id, total=total, counts=counts, **fields)

    def _bar(self, variant: Variant) -> RichTask:
        """Give the bar of a variant; a variant that is added later gets its bar then."""
        if variant not in self._bars:
            self.progress.add_task(escape(variant.title), total=0, known=0, grew=-math.inf, counts="")
            self._bars[variant] = self.progress.tasks[-1]
        return self._bars[variant]

    def __enter__(self) -> Self:
        (self._lines or self.progress).__enter__()
        return self

    def __exit__(self, *ended: Any) -> None:
        (self._lines or self.progress).__exit__(*ended)
