"""Worker processes, each of which can crash or hang without harm to the others."""

import faulthandler
import multiprocessing
import os
import re
import tempfile
import threading
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from multiprocessing.connection import wait as wait_for_any
from pathlib import Path
from typing import Any, Protocol

from reference_lcp.validation import checked_count, checked_scalar
from scenarios.execution.closing import Closing
from scenarios.execution.steady import answer_batch
from scenarios.tasks.result import Result
from scenarios.tasks.task import Task

TIME_LIMIT = 300.0
"""Seconds that a batch of questions may take: a hundred times what the slowest engine needs for the usual one."""

MOST_FAILURES = 3
"""Points at which an engine may end its process; after as many, its other points are not asked in this run."""

Batch = list[Task]


KILLED = "the worker process was killed"


class WorkerDied(RuntimeError):
    """A process has ended with its batch unanswered; the message says why."""


class Worker(Protocol):
    """Somebody who answers one batch at a time, in a process of their own."""

    def submit(self, batch: Batch, limit: float) -> Future[list[Result]]:
        """Start on a batch that may take `limit` seconds."""
        ...

    def result(self, future: Future[list[Result]], limit: float) -> list[Result]:
        """Give the answers, or raise `WorkerDied`."""
        ...

    def close(self) -> None:
        """Leave what is not begun undone."""
        ...


class ProcessWorker:
    """A process on this machine.

    Parameters
    ----------
    record
        File in which the process leaves a note when it dies.
    act
        What is done with a batch, in the process.
    """

    def __init__(self, record: Path, act: Callable[[Batch], list[Any]] = answer_batch):
        self._record = record
        self._act = act
        self._pool = self._new_pool()

    def submit(self, batch: Batch, limit: float) -> Future[list[Any]]:
        """Start on a batch; a process that died while it was idle is replaced."""
        self._record.write_text("")
        try:
            return self._pool.submit(partial(act_within, self._act), batch, limit, self._record)
        except BrokenProcessPool:
            self._replace()
            return self._pool.submit(partial(act_within, self._act), batch, limit, self._record)

    def result(self, future: Future[list[Any]], limit: float) -> list[Any]:
        """Give the answers, or replace the process and say why it has died."""
        try:
            return future.result()
        except BrokenProcessPool:
            self._replace()
            raise WorkerDied(reason_of_death(self._record.read_text(errors="replace"), limit)) from None

    def close(self) -> None:
        """End the process."""
        self._pool.shutdown(cancel_futures=True)

    def _replace(self) -> None:
        self.close()
        self._pool = self._new_pool()

    @staticmethod
    def _new_pool() -> ProcessPoolExecutor:
        # spawn: engines hold threads and locks that a forked child would find in an undefined state
        return ProcessPoolExecutor(1, multiprocessing.get_context("spawn"), initializer=end_with_parent)


def end_with_parent() -> None:
    """Let this process end when the one that started it is gone, however that ended."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=lambda: (wait_for_any([parent.sentinel]), os._exit(1)), daemon=True).start()


def answer_within(batch: Batch, limit: float, record: Path) -> list[Result]:
    """Answer a batch in this process; see `act_within`."""
    return act_within(answer_batch, batch, limit, record)


def act_within(act: Callable[[Batch], list[Any]], batch: Batch, limit: float, record: Path) -> list[Any]:
    """Do something with a batch in this process, or end the process and leave a note of where it was.

    The limit holds inside compiled code too, whether or not it lets other threads of Python run.
    """
    with record.open("w") as file:
        faulthandler.enable(file, all_threads=False)
        faulthandler.dump_traceback_later(limit, exit=True, file=file)
        try:
            return act(batch)
        finally:
            faulthandler.cancel_dump_traceback_later()
            faulthandler.disable()


def reason_of_death(note: str, limit: float) -> str:
    """Read the note that a process has left."""
    # of several threads, the one that began first, and does the work, comes last
    place = re.search(r'File "([^"]+)", line (\d+) in (\S+)', note.rsplit("Thread 0x", 1)[-1])
    where = f", in {place[3]} ({Path(place[1]).name}:{place[2]})" if place else ""
    if note.startswith("Timeout"):
        return f"stopped at the time limit of {limit:g} s{where}"
    fault = re.search(r"Fatal Python error: (.+)", note)
    return f"the worker process crashed: {fault[1]}{where}" if fault else KILLED


class Executor(Closing):
    """A number of workers, each with one batch at a time: who dies takes nobody else's work along.

    Parameters
    ----------
    hire
        Gives the worker of a place, when it is needed first.
    places
        Number of workers, >= 1.
    time_limit
        Seconds that a batch may take, > 0.

    Raises
    ------
    ParameterError
        If a number is outside its range.
    """

    def __init__(self, hire: Callable[[int], Worker], places: int, time_limit: float = TIME_LIMIT):
        self._hire = hire
        self._limit = checked_scalar("time_limit", time_limit, "> 0")
        self._idle = deque(range(checked_count("workers", places)))
        self._workers: dict[int, Worker] = {}

    def answers(self, batches: Sequence[Batch]) -> Iterator[tuple[Batch, list[Result]]]:
        """Answer batches as they come; one whose process dies is asked again question by question.

        A question whose process was killed, from outside or for want of memory, has a second chance.
        """
        again: set[Task] = set()
        waiting = deque(batches)
        failures: dict[str, list[str]] = {}
        running: dict[Future[list[Result]], tuple[int, Batch]] = {}
        while waiting or running:
            yield from self._start(waiting, running, failures)
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                place, batch = running.pop(future)
                try:
                    found = self._workers[place].result(future, self._limit)
                except WorkerDied as death:
                    if len(batch) > 1 or (str(death) == KILLED and batch[0] not in again):
                        waiting.extendleft([question] for question in reversed(batch))
                        again.update(batch[:1] if len(batch) == 1 else ())
                        found = []
                    else:
                        failures.setdefault(str(batch[0].variant), []).append(str(death))
                        found = [Result.blocked(str(death))]
                self._idle.append(place)
                # the worker has its next batch before the answers of this one are written
                yield from self._start(waiting, running, failures)
                if found:
                    yield batch, found

    def _start(
        self,
        waiting: deque[Batch],
        running: dict[Future[list[Result]], tuple[int, Batch]],
        failures: dict[str, list[str]],
    ) -> Iterator[tuple[Batch, list[Result]]]:
        """Give every idle worker a batch; gives back those of engines that are not asked any more, blocked."""
        while waiting and self._idle:
            batch = waiting.popleft()
            seen = failures.get(str(batch[0].variant), [])
            if len(seen) >= MOST_FAILURES:
                yield batch, [Result.blocked(f"not asked: {len(seen)} points before, {seen[-1]}")] * len(batch)
                continue
            place = self._idle.popleft()
            running[self._worker(place).submit(batch, self._limit)] = place, batch

    def close(self) -> None:
        """End every process; what they have not begun is left undone."""
        for worker in self._workers.values():
            worker.close()
        self._workers.clear()

    def _worker(self, place: int) -> Worker:
        if place not in self._workers:
            self._workers[place] = self._hire(place)
        return self._workers[place]


class LocalExecutor(Executor):
    """Processes on this machine.

    Parameters
    ----------
    workers
        Number of processes; as many as there are processors without it.
    time_limit
        Seconds that a batch may take, > 0.
    """

    def __init__(self, workers: int | None = None, time_limit: float = TIME_LIMIT):
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        super().__init__(self._hired, workers if workers is not None else (os.cpu_count() or 1), time_limit)

    def close(self) -> None:
        """End every process."""
        super().close()
        if self._folder is not None:
            self._folder.cleanup()
            self._folder = None

    def _hired(self, place: int) -> Worker:
        if self._folder is None:
            self._folder = tempfile.TemporaryDirectory(prefix="multibody-xval-")
        return ProcessWorker(Path(self._folder.name) / str(place))
