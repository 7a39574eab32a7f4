"""Worker processes on this machine, each of which can crash, hang or be stopped without harm to the others."""

import os
import sys
import time
from collections.abc import Collection
from contextlib import suppress
from queue import Empty, SimpleQueue

from engines.interface import registry
from reference_lcp.refusal import ParameterError
from scenarios.execution.computation.batch import Batch
from scenarios.execution.computation.failures import ExecutorError
from scenarios.execution.executor import InProcessExecutor, WorkerDied, WorkerExecutor
from scenarios.execution.limits import TIME_LIMIT
from scenarios.execution.storage.scratch import ScratchFolder
from scenarios.execution.workers.identity import identity_of
from scenarios.execution.workers.local_worker import LocalWorker
from scenarios.execution.workers.worker_template import WorkerTemplate
from scenarios.tasks.result import Result

IDLE_WORKERS = 8
"""Idle processes that are kept for their engine beside the busy ones: importing an engine takes up to a second."""


def executor_here(workers: int | None = None, time_limit: float = TIME_LIMIT) -> "LocalExecutor | InProcessExecutor":
    """Give what runs batches on this machine: worker processes, or this process where the system has none.

    Parameters
    ----------
    workers, time_limit
        As for `LocalExecutor`; without processes there is one worker, and nothing is stopped at the limit.

    Raises
    ------
    ParameterError
        If a number is outside its range, or there are more workers than this system can have.
    """
    executor = LocalExecutor(workers, time_limit)  # it starts nothing so far
    reason = unavailable_reason()
    if reason is None:
        return executor
    if workers not in (None, 1):
        raise ParameterError(f"workers = {workers}; allowed here: 1, since {reason}")
    print(f"{reason}: one that crashes or hangs ends the command; what is stored stays", file=sys.stderr)
    return InProcessExecutor()


def unavailable_reason() -> str | None:
    """Give the reason why there are no worker processes here; ``None`` where there are."""
    system: str = sys.platform
    if system == "linux":
        return None
    return f"worker processes need Linux, and this is {system}; engines run in the process of the command"


class LocalExecutor(WorkerExecutor[LocalWorker]):
    """Processes on this machine, each for one engine.

    Parameters
    ----------
    workers
        Number of processes that compute at a time; as many as there are processors without it.
    time_limit
        Seconds that a batch may take, > 0.

    Raises
    ------
    ParameterError
        If a number is outside its range.
    """

    def __init__(self, workers: int | None = None, time_limit: float = TIME_LIMIT):
        super().__init__(workers if workers is not None else (os.cpu_count() or 1), time_limit)
        self._workers: list[LocalWorker] = []
        self._started = 0
        self._news: SimpleQueue[None] = SimpleQueue()
        self._folder: ScratchFolder | None = None
        self._template: WorkerTemplate | None = None

    def run_for_client(self, batch: Batch, identity: str, limit: float) -> list[Result]:
        """Run a batch of a client on another machine, to which the identity belongs.

        Raises
        ------
        WorkerDied
            If the process crashed, was killed or passed the limit [s].
        """
        worker = self._worker_for(batch[0].variant.engine)
        worker.run(batch, identity, limit)
        self._finished([worker])
        return self._results(worker)

    def close(self) -> None:
        """End every process."""
        for worker in self._workers:
            worker.dismiss()
        for worker in self._workers:
            worker.end()
        self._workers.clear()
        if self._template is not None:
            self._template.close()
            self._template = None
        if self._folder is not None:
            self._folder.close()
            self._folder = None

    def _start(self, batch: Batch) -> LocalWorker:
        worker = self._worker_for(batch[0].variant.engine)
        worker.run(batch, identity_of(batch[0].variant), self._limit)
        return worker

    def _finished(self, running: Collection[LocalWorker]) -> Collection[LocalWorker]:
        while True:
            finished = [worker for worker in running if worker.finished()]
            if finished:
                return finished
            first = min(worker.deadline for worker in running) - time.monotonic()
            with suppress(Empty):
                self._news.get(timeout=max(0.0, first))

    def _results(self, run: LocalWorker) -> list[Result]:
        try:
            return run.results()
        except WorkerDied:
            self._end(run)
            raise

    def _abandon(self, run: LocalWorker) -> None:
        self._end(run)

    def _worker_for(self, engine: str) -> LocalWorker:
        """Give an idle process for this engine, the one used last; a new one if there is none."""
        engine = registry.engine(engine).host
        for worker in [worker for worker in self._workers if not (worker.busy or worker.alive())]:
            self._end(worker)
        idle = [worker for worker in self._workers if not worker.busy]
        own = [worker for worker in idle if worker.engine == engine]
        if own:
            self._workers.remove(own[-1])
            self._workers.append(own[-1])
            return own[-1]
        if len(idle) > IDLE_WORKERS:
            self._end(idle[0])
        worker = self._new_worker(engine)
        self._workers.append(worker)
        return worker

    def _new_worker(self, engine: str) -> LocalWorker:
        reason = unavailable_reason()
        if reason is not None:
            raise ExecutorError(reason)
        if self._folder is None:
            self._folder = ScratchFolder()
        if self._template is None:
            self._template = WorkerTemplate(self._folder.path)
        self._started += 1
        return LocalWorker(engine, self._template, self._folder.path / str(self._started), self._news)

    def _end(self, worker: LocalWorker) -> None:
        self._workers.remove(worker)
        worker.end()
