"""Worker processes on this machine, each of which can crash, hang or be stopped without harm to the others."""

import math
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Collection
from contextlib import suppress
from multiprocessing.connection import wait
from pathlib import Path

from scenarios.execution.batch import Batch
from scenarios.execution.executor import KILLED, TIME_LIMIT, WorkerDied, WorkerExecutor
from scenarios.execution.identity import identity_of
from scenarios.execution.worker import BEGUN, END_SECONDS, limit_reached, reason_of_death
from scenarios.tasks.result import Result

START_SECONDS = 60.0
"""What a process has to start and to import the suite, on a machine that is busy."""

GRACE_SECONDS = 1.0
"""By how much a process may pass the time limit, in which it writes its crash log."""

CHECK_SECONDS = 1.0
"""Interval of the check for processes that have ended while a child process holds the connection open."""

IDLE_WORKERS = 8
"""Idle processes that are kept for their engine beside the busy ones: starting one takes seconds."""

_START = (
    "import sys; sys.path[:] = {path!r}; from scenarios.execution.worker import serve; serve({descriptor}, {log!r})"
)


class LocalExecutor(WorkerExecutor["LocalWorker"]):
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
        self._folder: tempfile.TemporaryDirectory[str] | None = None

    def close(self) -> None:
        """End every process."""
        for worker in self._workers:
            worker.dismiss()
        for worker in self._workers:
            worker.end()
        self._workers.clear()
        if self._folder is not None:
            self._folder.cleanup()
            self._folder = None

    def _start(self, batch: Batch) -> "LocalWorker":
        worker = self._worker_for(batch[0].variant.engine)
        try:
            worker.run(batch, self._limit)
        except OSError:  # it has died while it was idle
            self._end(worker)
            worker = self._worker_for(worker.engine)
            worker.run(batch, self._limit)
        return worker

    def _finished(self, running: Collection["LocalWorker"]) -> Collection["LocalWorker"]:
        while True:
            finished = [worker for worker in running if worker.finished()]
            if finished:
                return finished
            first = min(worker.deadline for worker in running) - time.monotonic()
            wait([worker.connection for worker in running], max(0.0, min(first, CHECK_SECONDS)))

    def _results(self, run: "LocalWorker") -> list[Result]:
        try:
            return run.results()
        except WorkerDied:
            self._end(run)
            raise

    def _abandon(self, run: "LocalWorker") -> None:
        self._end(run)

    def _worker_for(self, engine: str) -> "LocalWorker":
        """Give an idle process of this engine, the one used last; a new one if there is none."""
        idle = [worker for worker in self._workers if not worker.busy]
        own = [worker for worker in idle if worker.engine == engine]
        if own:
            self._workers.remove(own[-1])
            self._workers.append(own[-1])
            return own[-1]
        if len(idle) > IDLE_WORKERS:
            self._end(idle[0])
        if self._folder is None:
            self._folder = tempfile.TemporaryDirectory(prefix="multibody-xval-")
        self._started += 1
        self._workers.append(LocalWorker(engine, Path(self._folder.name) / str(self._started)))
        return self._workers[-1]

    def _end(self, worker: "LocalWorker") -> None:
        self._workers.remove(worker)
        worker.end()


class LocalWorker:
    """A fresh Python process with a process group of its own, which runs one batch at a time.

    It does not import the program that started it, and no Ctrl-C of the terminal reaches it. It ends when its
    connection is closed, which the end of the starting process does too.

    Parameters
    ----------
    engine
        The only one whose batches it is given: what an engine does to its process affects no other engine.
    crash_log
        File into which it writes where it crashed.
    """

    def __init__(self, engine: str, crash_log: Path):
        self.engine = engine
        self.deadline = math.inf
        self._crash_log = crash_log
        self._limit = math.inf
        self._busy = self._begun = False
        self._reply: list[Result] | str | None = None
        self._size = 0
        self.connection, far = multiprocessing.Pipe()
        with far:
            start = _START.format(path=sys.path, descriptor=far.fileno(), log=str(crash_log))
            self._process = subprocess.Popen(
                [sys.executable, "-c", start],
                stdin=subprocess.DEVNULL,
                pass_fds=[far.fileno()],
                start_new_session=True,
            )

    @property
    def busy(self) -> bool:
        """Whether it has a batch."""
        return self._busy

    def run(self, batch: Batch, limit: float) -> None:
        """Start on a batch that may take `limit` seconds."""
        self.connection.send_bytes(pickle.dumps((batch, identity_of(batch[0].variant), limit)))
        self._busy, self._begun, self._reply, self._size, self._limit = True, False, None, len(batch), limit
        self.deadline = time.monotonic() + START_SECONDS

    def finished(self) -> bool:
        """Whether the batch has ended: with results, with the process, or at the time limit."""
        with suppress(EOFError, OSError, pickle.UnpicklingError):
            while self.connection.poll():
                reply = self.connection.recv()
                if reply != BEGUN:
                    self._reply = reply
                    return True
                self._begun, self.deadline = True, time.monotonic() + self._limit + GRACE_SECONDS
            return time.monotonic() > self.deadline or self._ended()
        return True

    def results(self) -> list[Result]:
        """Give the results of a batch that has ended, or raise `WorkerDied`."""
        if self._reply is None:
            raise self._death()
        self._busy, self.deadline = False, math.inf
        return [Result.blocked(self._reply)] * self._size if isinstance(self._reply, str) else self._reply

    def dismiss(self) -> None:
        """Let it end, at once if it is busy."""
        self.connection.close()
        if self._busy:
            self._kill()

    def end(self) -> None:
        """End it, and every process that it has started."""
        self.dismiss()
        until = time.monotonic() + END_SECONDS
        while not self._ended() and time.monotonic() < until:
            time.sleep(0.01)
        self._kill()
        self._process.wait()

    def _death(self) -> WorkerDied:
        """End it, and say why its batch has no results."""
        late = time.monotonic() > self.deadline
        self.dismiss()
        reason = reason_of_death(self._crash_log.read_text(errors="replace"), self._limit)
        if reason is None and late and self._begun:
            reason = limit_reached(self._limit)
        if reason is not None:
            return WorkerDied(reason, by_engine=True)
        return WorkerDied(f"no worker process started within {START_SECONDS:g} s" if late else KILLED)

    def _kill(self) -> None:
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(self._process.pid, signal.SIGKILL)

    def _ended(self) -> bool:
        """Whether the process has ended, and leave its number taken, which is that of its process group."""
        return os.waitid(os.P_PID, self._process.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None
