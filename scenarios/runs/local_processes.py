"""Worker processes on this machine, each of which can crash, hang or be stopped without harm to the others."""

import os
import pickle
import select
import signal
import sys
from collections.abc import Collection, Iterator
from concurrent.futures import Future, wait
from contextlib import contextmanager
from pathlib import Path
from threading import Thread, Timer

from engines.interface import registry
from reference_lcp.errors import ParameterError
from reference_lcp.terminal import say_in_terminal
from scenarios.runs import TIME_LIMIT
from scenarios.runs.executor import KILLED, Batch, Executor, InProcessExecutor, Run, WorkerDied, WorkerExecutor
from scenarios.runs.failures import ExecutorError
from scenarios.runs.result import Result
from scenarios.runs.scratch import ScratchFolder
from scenarios.runs.worker import BEGUN, KEPT_SECONDS, Preparing, identity_of, limit_reached, reason_of_death
from scenarios.runs.worker_template import END_SECONDS, START_SECONDS, WorkerTemplate

GRACE_SECONDS = 1.0
"""By how much a process may pass the time limit, in which it writes its crash log."""

IDLE_WORKERS = 8
"""Idle processes that are kept for their engine beside the busy ones: importing an engine takes up to a second."""


class LocalWorker:
    """A process forked from a template, below a supervisor, which runs one batch of its engine at a time.

    It does not import the program that started it, and no Ctrl-C of the terminal reaches it. When the starting process
    ends, so does it, with every process that an engine has started in it; see `supervise`.
    """

    def __init__(self, engine: str, template: WorkerTemplate, crash_log: Path):
        self.engine = engine
        self._crash_log = crash_log
        self._late = False
        self._run: Run | None = None
        self._connection, self._lifeline, self._supervisor = template.fork(crash_log)

    @property
    def busy(self) -> bool:
        """Whether it runs a batch."""
        return self._run is not None and not self._run.done()

    def alive(self) -> bool:
        """Whether it would take a batch."""
        return not (self._lifeline.closed or self._ended(0.0))

    def run(self, batch: Batch, identity: str, limit: float) -> Run:
        """Start on a batch, see `serve`, that may take `limit` seconds; gives its results, or `WorkerDied`."""
        run: Run = Future()

        def exchange() -> None:
            try:
                run.set_result(self._exchange(batch, identity, limit))
            except BaseException as problem:
                run.set_exception(problem)

        self._run = run
        Thread(target=exchange, daemon=True).start()  # a worker may be stopped in the middle of a message
        return run

    def dismiss(self) -> None:
        """Let its supervisor end it, and every process that it has started."""
        self._lifeline.close()

    def end(self) -> None:
        """See that they have ended, and free what is held."""
        if self._connection.closed:
            return
        self._stop()
        if self._run is not None:
            wait([self._run], END_SECONDS)
        self._connection.close()
        os.close(self._supervisor)

    def _exchange(self, batch: Batch, identity: str, limit: float) -> list[Result]:
        """Send a batch and wait for the reply, while the limit of what has begun counts."""
        begun: str | Preparing | None = None
        try:
            with self._stopped_after(START_SECONDS):
                self._connection.send_bytes(pickle.dumps((batch, identity, limit)))
                reply = self._connection.recv()
            while reply == BEGUN or isinstance(reply, Preparing):
                begun = reply
                with self._stopped_after((begun.limit if isinstance(begun, Preparing) else limit) + GRACE_SECONDS):
                    if isinstance(begun, Preparing) and not self._connection.poll(KEPT_SECONDS):
                        say_in_terminal(begun.notice)
                    reply = self._connection.recv()
        except Exception:  # it has died, or its engine has written into the connection
            raise self._death(begun, limit) from None
        return [Result.blocked(reply)] * len(batch) if isinstance(reply, str) else reply

    @contextmanager
    def _stopped_after(self, seconds: float) -> Iterator[None]:
        def stop() -> None:
            self._late = True
            self._stop()

        timer = Timer(seconds, stop)
        timer.daemon = True
        timer.start()
        try:
            yield
        finally:
            timer.cancel()

    def _stop(self) -> None:
        self.dismiss()
        if not self._ended(END_SECONDS):
            signal.pidfd_send_signal(self._supervisor, signal.SIGKILL)
            self._ended(None)

    def _ended(self, within: float | None) -> bool:
        """Whether its supervisor ends within so many seconds; without a number, wait until it has."""
        end = select.poll()
        end.register(self._supervisor, select.POLLIN)
        return bool(end.poll(None if within is None else 1000 * within))

    def _death(self, begun: str | Preparing | None, limit: float) -> WorkerDied:
        """End it, and say why its batch has no results."""
        self._stop()
        preparing = begun if isinstance(begun, Preparing) else None
        limit = limit if preparing is None else preparing.limit
        crash_log = self._crash_log.read_text(errors="replace") if self._crash_log.exists() else ""
        reason = reason_of_death(crash_log, limit)
        if reason is None and self._late and begun is not None:
            reason = limit_reached(limit)
        if reason is not None and preparing is not None:
            return WorkerDied(f"{preparing.what}: {reason}", preparing=True)
        if reason is not None:
            return WorkerDied(reason, by_engine=True)
        return WorkerDied(f"no worker process started within {START_SECONDS:g} s" if self._late else KILLED)


def executor_here(workers: int | None = None, time_limit: float = TIME_LIMIT) -> Executor:
    """Give what runs batches on this machine: worker processes, or this process where the system has none.

    Without processes there is one worker, and nothing is stopped at the limit; more workers are refused.
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


class LocalExecutor(WorkerExecutor):
    """Processes on this machine, each for one engine: what an engine does to its process affects no other engine.

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
        self._folder: ScratchFolder | None = None
        self._template: WorkerTemplate | None = None

    def run_for_client(self, batch: Batch, identity: str, limit: float) -> list[Result]:
        """Run a batch of a client on another machine, to which the identity belongs, or raise `WorkerDied`."""
        return self._worker_for(batch[0].variant.engine).run(batch, identity, limit).result()

    def close(self) -> None:
        """End every process."""
        self._end(self._workers)
        if self._template is not None:
            self._template.close()
            self._template = None
        if self._folder is not None:
            self._folder.close()
            self._folder = None

    def _start(self, batch: Batch) -> Run:
        worker = self._worker_for(batch[0].variant.engine)
        return worker.run(batch, identity_of(batch[0].variant), self._limit)

    def _abandon(self, running: Collection[Run]) -> None:
        self._end([worker for worker in self._workers if worker.busy])

    def _worker_for(self, engine: str) -> LocalWorker:
        """Give an idle process for this engine, the one used last; a new one if there is none."""
        engine = registry.engine(engine).host
        self._end([worker for worker in self._workers if not (worker.busy or worker.alive())])
        idle = [worker for worker in self._workers if not worker.busy]
        same = [worker for worker in idle if worker.engine == engine]
        if same:
            self._workers.remove(same[-1])
            self._workers.append(same[-1])
            return same[-1]
        if len(idle) > IDLE_WORKERS:
            self._end(idle[:1])
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
        return LocalWorker(engine, self._template, self._folder.path / str(self._started))

    def _end(self, workers: Collection[LocalWorker]) -> None:
        for worker in workers:
            worker.dismiss()
        for worker in list(workers):
            worker.end()
            self._workers.remove(worker)
