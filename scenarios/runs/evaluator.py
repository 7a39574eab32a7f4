"""Tasks to results: from the store where they are known, from an executor where not."""

import itertools
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cache

from multibody_xval.scenarios.runs.executor import Executor, InProcessExecutor, batches_of
from multibody_xval.scenarios.runs.result import NOT_INSTALLED, UNREPRESENTABLE, Result, ResultStatus
from multibody_xval.scenarios.runs.scratch import Closing
from multibody_xval.scenarios.runs.store import ResultStore
from multibody_xval.scenarios.runs.task import Task

Ended = Callable[[Task, Result], None]
"""Takes a task and its result."""


class Progress:
    """Is told how far an evaluator is; this one says nothing of it."""

    def expect(self, tasks: Sequence[Task]) -> None:
        """Take tasks that are about to be evaluated."""

    def advance(self, tasks: Sequence[Task]) -> None:
        """Take tasks of one variant whose results have just been computed."""

    def recall(self, tasks: Sequence[Task]) -> None:
        """Take tasks of one variant that need no computation."""

    def stage(self, name: str) -> None:
        """Take the name of what is evaluated next."""


class Evaluator(Closing):
    """Gives the results of tasks, and keeps every one the moment it is there; its executor is closed with it.

    Tasks at which their engine has failed before are run again where they are to be (`retry_blocked`); those that other
    reasons blocked, such as a worker that was killed, in any case.
    """

    def __init__(
        self, store: ResultStore, executor: Executor, progress: Progress | None = None, *, retry_blocked: bool = False
    ):
        self._store, self._executor, self._retry_blocked = store, executor, retry_blocked
        self.progress = progress or Progress()
        self._results: dict[Task, Result] = {}
        # Looked up once a variant: 100,000 points take no time.
        self._unavailable = cache(lambda variant: variant.unavailable_reason)

    def evaluate(self, tasks: Sequence[Task]) -> list[Result]:
        """Give the result of every task, in order; that of a repeated task comes from memory, blocked or not."""
        new = self.new_tasks(tasks)
        if new:
            self.progress.expect(new)
            self.complete(new, self._results.__setitem__)
        return [self._results[task] for task in tasks]

    def complete(self, tasks: Iterable[Task], ended: Ended = lambda _task, _result: None) -> None:
        """Run what the store does not hold, and release each result once it is stored.

        Tasks are taken as there are workers for them: however many there are, neither they nor their results are in
        memory together.
        """
        for batch, results in self._executor.run(batches_of(self._missing(tasks, ended))):
            self._store.keep(zip(batch, results, strict=True))
            self.progress.advance(batch)
            for task, result in zip(batch, results, strict=True):
                ended(task, result)

    def _missing(self, tasks: Iterable[Task], ended: Ended) -> Iterator[Task]:
        """Give what has to be run; what is stored, and what can have no result, has ended."""
        recalled: list[Task] = []
        tasks, looked_up = itertools.tee(tasks)
        for task, stored in zip(tasks, self._store.results(looked_up), strict=True):
            known = stored
            if stored is None or stored.status is ResultStatus.BLOCKED:
                reason = self._skip_reason(task)
                known = self._recalled(stored) if reason is None else Result.blocked(reason)
            if recalled and (known is None or task.variant != recalled[0].variant):
                self.progress.recall(recalled)
                recalled = []
            if known is None:
                yield task
            else:
                recalled.append(task)
                ended(task, known)
        if recalled:
            self.progress.recall(recalled)

    def new_tasks(self, tasks: Sequence[Task]) -> list[Task]:
        """Give the tasks that this evaluator has not evaluated so far, each once."""
        return list(dict.fromkeys(task for task in tasks if task not in self._results))

    def stage(self, name: str) -> None:
        """Name what is evaluated next."""
        self.progress.stage(name)

    def close(self) -> None:
        """Close the executor; what has not begun is left undone."""
        self._executor.close()

    def _recalled(self, stored: Result | None) -> Result | None:
        """Give a result of the store; ``None`` if its task is to be run again."""
        if stored is None or stored.status is not ResultStatus.BLOCKED:
            return stored
        return stored if stored.by_engine and not self._retry_blocked else None

    def _skip_reason(self, task: Task) -> str | None:
        """Give the reason to skip a task: its engine is not installed, or cannot represent it; ``None`` without one."""
        unavailable = self._unavailable(task.variant)
        if unavailable is not None:
            return f"{NOT_INSTALLED}: {unavailable}"
        unsupported = task.unsupported_reason()
        return None if unsupported is None else f"{UNREPRESENTABLE}: {unsupported}"


class StoredResults(Evaluator):
    """The results of a store: nothing is computed, and what it does not hold is missing; refused if it is damaged."""

    def __init__(self, store: ResultStore):
        super().__init__(store, InProcessExecutor())  # it gets no tasks
        store.check_pages()

    def _recalled(self, stored: Result | None) -> Result | None:
        return stored or Result.missing()
