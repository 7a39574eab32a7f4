"""Executors: what runs batches of tasks, and gives their results as they come."""

from abc import abstractmethod
from collections import Counter, defaultdict, deque
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from itertools import islice
from typing import Any

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.scene import SceneTask, run_scenes
from multibody_xval.scenarios.runs.scratch import Closing
from multibody_xval.scenarios.runs.steady import run_steady_states
from multibody_xval.scenarios.runs.task import Task
from multibody_xval.scenarios.runs.transient import run_transients
from multibody_xval.scenarios.runs.transient_task import TransientTask
from reference_lcp.validation import LONGEST_TIME_LIMIT, MOST_WORKERS, checked_count, checked_scalar

Batch = list[Task]
"""Tasks of one type, for one variant, on chains of one length."""


def run_batch(batch: Sequence[Task]) -> list[Result]:
    """Run a batch in this process; gives a result a task, in order.

    An engine that is not installed, or that fails on a task, gives a blocked result with the reason.
    """
    run: Callable[[Any], list[Result]] = run_steady_states
    if isinstance(batch[0], TransientTask):
        run = run_transients
    elif isinstance(batch[0], SceneTask):
        run = run_scenes
    return run(batch)


def batches_of(tasks: Iterable[Task]) -> Iterator[Batch]:
    """Group tasks into batches as large as their variant takes at once; those that are not full come at the end."""
    groups: dict[tuple[type[Task], Variant, int], Batch] = defaultdict(list)
    for task in tasks:
        key = type(task), task.variant, task.cells
        groups[key].append(task)
        if len(groups[key]) == task.variant.batch_lanes:
            yield groups.pop(key)
    yield from groups.values()


MOST_PUT_OFF = 1000
"""Batches that wait for the first one of their engine, and are looked past for one of another."""

MOST_FAILURES = 3
"""Points at which an engine may end its process; after as many, its other points are not run any more."""

KILLED = "the worker process was killed"


class Executor(Closing):
    """Runs batches of tasks."""

    @abstractmethod
    def run(self, batches: Iterable[Batch]) -> Iterator[tuple[Batch, list[Result]]]:
        """Run batches, and give the results of each, in the order of its tasks, as soon as they are there.

        Batches are taken one by one, when there is somewhere to run them. A batch may come back in parts.
        """

    def warm_up(self) -> None:
        """Start what all batches need, beside what comes before the first: nothing, unless said otherwise."""

    def close(self) -> None:
        """Free what is held: nothing, unless said otherwise."""


class InProcessExecutor(Executor):
    """Runs batches in this process, one after the other; an engine that crashes or hangs takes it along."""

    def run(self, batches: Iterable[Batch]) -> Iterator[tuple[Batch, list[Result]]]:
        """Run batches; see `Executor.run`."""
        for batch in batches:
            yield batch, run_batch(batch)


class WorkerDied(RuntimeError):
    """A worker has ended with its batch undone: by its engine if that crashed or hung, maybe while it was prepared.

    One that had been killed or stopped before may not have begun with it.
    """

    def __init__(self, reason: str, *, by_engine: bool = False, preparing: bool = False, begun: bool = True):
        super().__init__(reason)
        self.by_engine, self.preparing, self.begun = by_engine, preparing, begun


Run = Future[list[Result]]
"""A running batch; its exception is a `WorkerDied`."""


class WorkerExecutor(Executor):
    """Batches in workers, as many at a time as there are slots: a worker that dies takes no other's batch along.

    A batch may take `time_limit` seconds.
    """

    def __init__(self, slots: int, time_limit: float):
        self._slots = checked_count("workers", slots, 1, MOST_WORKERS)
        self._limit = checked_scalar("time_limit", time_limit, "> 0", LONGEST_TIME_LIMIT)

    def run(self, batches: Iterable[Batch]) -> Iterator[tuple[Batch, list[Result]]]:
        """Run batches; see `Executor.run`. One whose worker dies is run again task by task."""
        queue = BatchQueue(batches)
        running: dict[Run, Batch] = {}
        try:
            yield from self._fill(queue, running)
            while running:
                self._wait(running)
                for run in [run for run in running if run.done()]:
                    batch = running.pop(run)
                    queue.tried.add(batch[0].variant)
                    try:
                        results = self._results(run)
                    except WorkerDied as death:
                        results = queue.died(batch, death)
                    # the worker has its next batch before the results of this one are written
                    yield from self._fill(queue, running)
                    if results:
                        yield batch, results
        finally:
            self._abandon(running)

    def _fill(self, queue: "BatchQueue", running: dict[Run, Batch]) -> Iterator[tuple[Batch, list[Result]]]:
        """Start batches in all free slots; gives back those that are not run any more, blocked."""
        while len(running) < self._slots and (batch := queue.next(running.values())) is not None:
            reason = queue.blocked.get(batch[0].variant)
            if reason is None:
                running[self._start(batch)] = batch
            else:
                yield batch, [Result.blocked(reason)] * len(batch)

    @abstractmethod
    def _start(self, batch: Batch) -> Run:
        """Give a batch to a worker."""

    @abstractmethod
    def _abandon(self, running: Collection[Run]) -> None:
        """Stop batches whose results are not needed any more."""

    def _wait(self, running: Collection[Run]) -> None:
        """Wait until at least one has ended, somehow."""
        wait(running, return_when=FIRST_COMPLETED)

    def _results(self, run: Run) -> list[Result]:
        """Give the results of what has ended, or raise `WorkerDied`."""
        return run.result()


class BatchQueue:
    """Batches that wait to be run, taken one by one, and what becomes of those whose worker died."""

    def __init__(self, batches: Iterable[Batch]):
        self._batches = iter(batches)
        self._put_off: deque[Batch] = deque()
        self._again: deque[Batch] = deque()
        self._second_chance: set[Task] = set()
        self._failures: Counter[Variant] = Counter()
        self.blocked: dict[Variant, str] = {}
        """Why a variant is not run any more: it has failed at `MOST_FAILURES` points, or could not be prepared."""
        self.tried: set[Variant] = set()
        """Variants of which a batch has ended."""

    def next(self, running: Collection[Batch]) -> Batch | None:
        """Take the next batch, those that are run again first; ``None`` without any.

        While the first batch of a variant runs, others of its package are put off as long as there is anything else:
        what it compiles they then find compiled.
        """
        if self._again:
            return self._again.popleft()
        beginning = {_package(batch) for batch in running if batch[0].variant not in self.tried}
        for batch in self._put_off:
            if _package(batch) not in beginning:
                self._put_off.remove(batch)
                return batch
        for batch in islice(self._batches, MOST_PUT_OFF - len(self._put_off)):
            if _package(batch) not in beginning:
                return batch
            self._put_off.append(batch)
        return self._put_off.popleft() if self._put_off else None

    def died(self, batch: Batch, death: WorkerDied) -> list[Result]:
        """Queue the tasks of a batch one by one; one that was alone is blocked: gives its result.

        A task whose process was killed, from outside or for want of memory, has a second chance, and so has a batch, as
        it is, that no process has begun with. All are blocked where their variant could not be prepared: on another
        day, or after a look at the machine, it may be.
        """
        alone, reason, variant = len(batch) == 1, str(death), batch[0].variant
        if death.preparing:
            self.blocked[variant] = reason
            return [Result.blocked(reason)] * len(batch)
        if not (death.begun or self._second_chance.issuperset(batch)):
            self._again.appendleft(batch)
            self._second_chance.update(batch)
            return []
        if alone and (reason != KILLED or batch[0] in self._second_chance):
            self._failures[variant] += 1
            if self._failures[variant] >= MOST_FAILURES:
                self.blocked[variant] = f"not run: {self._failures[variant]} points before, {reason}"
            return [Result.blocked(reason, by_engine=death.by_engine)]
        self._again.extendleft([task] for task in reversed(batch))
        self._second_chance.update(batch if alone else ())
        return []


def _package(batch: Batch) -> str:
    return batch[0].variant.capabilities.package
