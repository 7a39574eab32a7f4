"""Worker processes, each of which can crash or hang without harm to the others."""

import faulthandler
import multiprocessing
import re
import tempfile
from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from types import TracebackType
from typing import Self

from reference_lcp.validation import checked_count, checked_scalar
from scenarios.answering import answer_batch
from scenarios.questions import Answer, Question

TIME_LIMIT = 300.0
"""Seconds that a batch of questions may take: a hundred times what the slowest engine needs for the usual one."""

MOST_FAILURES = 3
"""Points at which an engine may end its process; after as many, its other points are not asked in this run."""


class Worker:
    """One process that answers one batch of questions at a time.

    Parameters
    ----------
    record
        File in which the process leaves a note when it dies.
    """

    def __init__(self, record: Path):
        self._record = record
        # spawn: engines hold threads and locks that a forked child would find in an undefined state
        self._pool = ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn"))

    def submit(self, batch: Sequence[Question], limit: float) -> Future[list[Answer]]:
        """Start on a batch; the process ends itself when it takes longer than `limit` [s]."""
        self._record.write_text("")
        return self._pool.submit(answer_within, batch, limit, self._record)

    def reason_of_death(self, limit: float) -> str:
        """Say why the process has died, in a sentence."""
        note = self._record.read_text(errors="replace")
        # of several threads, the one that began first, and does the work, comes last
        place = re.search(r'File "([^"]+)", line (\d+) in (\S+)', note.rsplit("Thread 0x", 1)[-1])
        where = f", in {place[3]} ({Path(place[1]).name}:{place[2]})" if place else ""
        if note.startswith("Timeout"):
            return f"stopped at the time limit of {limit:g} s{where}"
        fault = re.search(r"Fatal Python error: (.+)", note)
        return f"the worker process crashed: {fault[1]}{where}" if fault else "the worker process was killed"

    def close(self) -> None:
        """End the process."""
        self._pool.shutdown(cancel_futures=True)


def answer_within(batch: Sequence[Question], limit: float, record: Path) -> list[Answer]:
    """Answer a batch in this process, or end the process and leave a note of where it was.

    The limit holds inside compiled code too, whether or not it lets other threads of Python run.
    """
    with record.open("w") as file:
        faulthandler.enable(file, all_threads=False)
        faulthandler.dump_traceback_later(limit, exit=True, file=file)
        try:
            return answer_batch(batch)
        finally:
            faulthandler.cancel_dump_traceback_later()
            faulthandler.disable()


class IsolatedWorkers:
    """A number of workers, each with one batch at a time: who dies takes nobody else's work along.

    Parameters
    ----------
    workers
        Number of processes, >= 1.
    time_limit
        Seconds that a batch may take, > 0.

    Raises
    ------
    ParameterError
        If a number is outside its range.
    """

    def __init__(self, workers: int, time_limit: float = TIME_LIMIT):
        self._limit = checked_scalar("time_limit", time_limit, "> 0")
        self._idle: deque[int] = deque(range(checked_count("workers", workers)))
        self._workers: dict[int, Worker] = {}
        self._folder = tempfile.TemporaryDirectory(prefix="multibody-xval-")

    def answers(self, batches: Sequence[list[Question]]) -> Iterator[tuple[list[Question], list[Answer]]]:
        """Answer batches as they come; one whose process dies is asked again question by question."""
        waiting = deque(batches)
        failures: dict[str, list[str]] = {}
        running: dict[Future[list[Answer]], tuple[int, list[Question]]] = {}
        while waiting or running:
            while waiting and self._idle:
                batch = waiting.popleft()
                seen = failures.get(str(batch[0].variant), [])
                if len(seen) >= MOST_FAILURES:
                    yield batch, [Answer.blocked(f"not asked: {len(seen)} points before, {seen[-1]}")] * len(batch)
                    continue
                slot = self._idle.popleft()
                running[self._submit(slot, batch)] = slot, batch
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                slot, batch = running.pop(future)
                try:
                    yield batch, future.result()
                except BrokenProcessPool:
                    reason = self._bury(slot)
                    if len(batch) > 1:
                        waiting.extendleft([question] for question in reversed(batch))
                        continue
                    failures.setdefault(str(batch[0].variant), []).append(reason)
                    yield batch, [Answer.blocked(reason)]
                finally:
                    self._idle.append(slot)

    def close(self) -> None:
        """End every process; what they have not begun is left undone."""
        for worker in self._workers.values():
            worker.close()
        self._workers.clear()
        self._folder.cleanup()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _submit(self, slot: int, batch: list[Question]) -> Future[list[Answer]]:
        """Give a batch to the worker of a slot; one that died while it was idle is replaced."""
        try:
            return self._worker(slot).submit(batch, self._limit)
        except BrokenProcessPool:
            self._bury(slot)
            return self._worker(slot).submit(batch, self._limit)

    def _worker(self, slot: int) -> Worker:
        if slot not in self._workers:
            self._workers[slot] = Worker(Path(self._folder.name) / str(slot))
        return self._workers[slot]

    def _bury(self, slot: int) -> str:
        """Take leave of a dead worker; gives the reason of its death."""
        worker = self._workers.pop(slot)
        worker.close()
        return worker.reason_of_death(self._limit)
