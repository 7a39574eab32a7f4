"""Tasks to results: from the store where they are known, from an executor where not."""

import itertools
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cache
from typing import TypeVar

from scenarios.runs.executor import Executor, InProcessExecutor, batches_of
from scenarios.runs.result import Result, ResultStatus, ResultSummary
from scenarios.runs.scratch import Closing
from scenarios.runs.store import ResultStore
from scenarios.runs.task import Task

AT_ONCE = 500
"""Tasks that are looked up in the store at a time: workers wait for it, and the rest is not in memory so far."""

Progress = Callable[[Sequence[Task]], None]
"""Takes tasks of one variant that have just got their results: computed ones, or such as need no computation."""

Ended = Callable[[Task, ResultSummary], None]
"""Takes a task and how it ended."""

_Stored = TypeVar("_Stored", Result, ResultSummary)


class Evaluator(Closing):
    """Gives the results of tasks, and keeps every one the moment it is there.

    Parameters
    ----------
    store
        Where results are looked up and kept.
    executor
        What runs the tasks; it is closed with the evaluator.
    retry_blocked
        Whether tasks are run again at which their engine has failed before. Those that other reasons blocked, such as
        a worker that was killed, are run again in any case.

    Attributes
    ----------
    progress, recalled
        Called with tasks whose results have been computed, and with those that needed no computation.
    stage
        Called with the name of what is evaluated next.
    """

    def __init__(self, store: ResultStore, executor: Executor, *, retry_blocked: bool = False):
        self._store = store
        self._retry_blocked = retry_blocked
        self._executor = executor
        self._results: dict[Task, Result] = {}
        # Looked up once a variant: 100,000 points take no time.
        self._unavailable = cache(lambda variant: variant.unavailable_reason)
        self.progress: Progress = lambda _tasks: None
        self.recalled: Progress = lambda _tasks: None
        self.stage: Callable[[str], None] = lambda _name: None

    def evaluate(self, tasks: Sequence[Task]) -> list[Result]:
        """Give the result of every task, in order; that of a repeated task comes from memory, blocked or not."""
        missing = []
        for task, stored in self._stored(self.new_tasks(tasks), self._store.results):
            if stored is None:
                missing.append(task)
            else:
                self._results[task] = stored
                self.recalled([task])
        self._results.update(self._run(missing))
        return [self._results[task] for task in tasks]

    def complete(self, tasks: Iterable[Task], ended: Ended = lambda _task, _ended: None) -> None:
        """Run what the store does not hold, and release each result once it is stored.

        Tasks are taken as there are workers for them: however many there are, neither they nor their results are in
        memory together.
        """
        for task, result in self._run(self._missing(tasks, ended)):
            ended(task, ResultSummary.of(result))

    def _missing(self, tasks: Iterable[Task], ended: Ended) -> Iterator[Task]:
        remaining = iter(tasks)
        while some := list(itertools.islice(remaining, AT_ONCE)):
            for task, stored in self._stored(some, self._store.summaries):
                if stored is None:
                    yield task
                else:
                    self.recalled([task])
                    ended(task, ResultSummary.of(stored))

    def new_tasks(self, tasks: Sequence[Task]) -> list[Task]:
        """Give the tasks that this evaluator has not evaluated so far, each once."""
        return [task for task in dict.fromkeys(tasks) if task not in self._results]

    def close(self) -> None:
        """Close the executor; what has not begun is left undone."""
        self._executor.close()

    def _stored(
        self, tasks: Sequence[Task], look_up: Callable[[Iterable[Task]], Iterator[_Stored | None]]
    ) -> Iterator[tuple[Task, _Stored | Result | None]]:
        """Give each task, in order, with what needs no computation: what is stored, or why there can be no result."""
        reasons = [self._skip_reason(task) for task in tasks]
        stored = look_up([task for task, reason in zip(tasks, reasons, strict=True) if reason is None])
        for task, reason in zip(tasks, reasons, strict=True):
            yield task, self._recalled(next(stored)) if reason is None else Result.blocked(reason)

    def _recalled(self, stored: _Stored | None) -> _Stored | Result | None:
        """Give a result of the store; ``None`` if its task is to be run again."""
        if stored is None or stored.status is not ResultStatus.BLOCKED:
            return stored
        return stored if stored.by_engine and not self._retry_blocked else None

    def _run(self, tasks: Iterable[Task]) -> Iterator[tuple[Task, Result]]:
        for batch, results in self._executor.run(batches_of(tasks)):
            self._store.keep(zip(batch, results, strict=True))
            self.progress(batch)
            yield from zip(batch, results, strict=True)

    def _skip_reason(self, task: Task) -> str | None:
        """Give the reason to skip a task: its engine is not installed, or cannot represent it; ``None`` without one."""
        unavailable = self._unavailable(task.variant)
        if unavailable is not None:
            return f"not installed: {unavailable}"
        unsupported = task.unsupported_reason()
        return None if unsupported is None else f"cannot be represented: {unsupported}"


class StoredResults(Evaluator):
    """The results of a store: nothing is computed, and what it does not hold is missing.

    Parameters
    ----------
    store
        Where results are looked up.

    Raises
    ------
    ParameterError
        If the store is damaged so that results might seem to be missing.
    """

    def __init__(self, store: ResultStore):
        super().__init__(store, InProcessExecutor())  # it gets no tasks
        store.check_pages()

    def _recalled(self, stored: _Stored | None) -> _Stored | Result | None:
        return stored or Result.missing()
