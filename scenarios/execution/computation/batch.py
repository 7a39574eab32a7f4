"""Batches: tasks that one simulation runs together, and how each kind of task is run."""

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any

from engines.interface.variant import Variant
from scenarios.execution.computation.law_period import run_law_periods
from scenarios.execution.computation.steady import run_steady_states
from scenarios.execution.computation.transient import run_transients
from scenarios.tasks.block import BlockTask
from scenarios.tasks.inclined import InclinedTask
from scenarios.tasks.law_period import LawPeriodTask
from scenarios.tasks.recorded import RecordedPeriodTask
from scenarios.tasks.result import Result
from scenarios.tasks.task import SteadyStateTask, Task
from scenarios.tasks.transient import TransientTask

Batch = list[Task]
"""Tasks of one kind, for one variant, on chains of one length."""

_RUN: dict[type[Task], Callable[[Any], list[Result]]] = {
    SteadyStateTask: run_steady_states,
    RecordedPeriodTask: run_steady_states,
    TransientTask: run_transients,
    BlockTask: run_transients,
    InclinedTask: run_transients,
    LawPeriodTask: run_law_periods,
}


def run_batch(batch: Sequence[Task]) -> list[Result]:
    """Run a batch in this process; gives a result a task, in order.

    An engine that is not installed, or that fails on a task, gives a blocked result with the reason.
    """
    return _RUN[type(batch[0])](batch)


def batches_of(tasks: Iterable[Task]) -> Iterator[Batch]:
    """Group tasks into batches as large as their variant takes at once; those that are not full come at the end."""
    groups: dict[tuple[type[Task], Variant, int], Batch] = defaultdict(list)
    for task in tasks:
        key = type(task), task.variant, task.ratios.cells
        groups[key].append(task)
        if len(groups[key]) == task.variant.batch_lanes:
            yield groups.pop(key)
    yield from groups.values()
