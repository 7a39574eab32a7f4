"""A worker process on this machine, as its client sees it."""

import math
import os
import pickle
import subprocess
import sys
import time
from contextlib import suppress
from multiprocessing import Pipe
from pathlib import Path
from queue import SimpleQueue
from threading import Thread

from scenarios.execution.batch import Batch
from scenarios.execution.executor import KILLED, WorkerDied
from scenarios.execution.failures import ExecutorError
from scenarios.execution.worker import BEGUN, limit_reached, reason_of_death
from scenarios.tasks.result import Result

START_SECONDS = 60.0
"""What a process has to start and to import the suite, on a machine that is busy."""

GRACE_SECONDS = 1.0
"""By how much a process may pass the time limit, in which it writes its crash log."""

END_SECONDS = 1.0
"""What a supervisor has to end its processes; one that takes longer, as it has been stopped, is killed itself."""

_START = (
    "import sys; sys.path[:] = {path!r}; "
    "from scenarios.execution.supervisor import supervise; supervise({lifeline}, {descriptor}); "
    "from scenarios.execution.worker import serve; serve({descriptor}, {log!r})"
)


class LocalWorker:
    """A fresh Python process below a supervisor, which runs one batch at a time.

    It does not import the program that started it, and no Ctrl-C of the terminal reaches it. When the starting process
    ends, so does it, with every process that an engine has started in it; see `scenarios.execution.supervisor`.

    Parameters
    ----------
    engine
        The only one whose batches it is given: what an engine does to its process affects no other engine.
    folder
        Where it writes where it crashed, and where engines find their temporary folder.
    number
        Of the worker among those that share the folder.
    news
        Gets an item whenever `finished` and `deadline` have to be looked at anew.

    Raises
    ------
    ExecutorError
        If no process can be started.
    """

    def __init__(self, engine: str, folder: Path, number: int, news: "SimpleQueue[None]"):
        self.engine = engine
        self.deadline = math.inf
        self.busy = False
        self._crash_log = folder / str(number)
        self._news = news
        self._limit = math.inf
        self._begun = self._silent = False
        self._reply: list[Result] | str | None = None
        self._size = 0
        self._thread: Thread | None = None
        self._connection, far = Pipe()
        released, lifeline = os.pipe()
        self._lifeline: int | None = lifeline
        descriptors = {"lifeline": released, "descriptor": far.fileno()}
        start = _START.format(path=sys.path, log=str(self._crash_log), **descriptors)
        try:
            self._supervisor = subprocess.Popen(
                [sys.executable, "-c", start],
                stdin=subprocess.DEVNULL,
                stdout=2,
                env={**os.environ, "TMPDIR": str(folder)},
                pass_fds=list(descriptors.values()),
                start_new_session=True,
            )
        except OSError as problem:
            raise ExecutorError(f"a worker process cannot be started: {problem}") from None
        finally:
            far.close()
            os.close(released)

    def alive(self) -> bool:
        """Whether it would take a batch."""
        return self._supervisor.poll() is None

    def run(self, batch: Batch, identity: str, limit: float) -> None:
        """Start on a batch, see `scenarios.execution.worker.run_within`, that may take `limit` seconds."""
        self.busy, self._size, self._limit = True, len(batch), limit
        self._begun, self._silent, self._reply = False, False, None
        self.deadline = time.monotonic() + START_SECONDS
        message = pickle.dumps((batch, identity, limit))
        self._thread = Thread(target=self._exchange, args=(message,), daemon=True)
        self._thread.start()

    def finished(self) -> bool:
        """Whether the batch has ended: with results, with the process, or at the time limit."""
        return self._silent or time.monotonic() > self.deadline

    def results(self) -> list[Result]:
        """Give the results of a batch that has ended, or raise `WorkerDied`."""
        if not self._silent or self._reply is None:
            raise self._death()
        self.busy, self.deadline = False, math.inf
        return [Result.blocked(self._reply)] * self._size if isinstance(self._reply, str) else self._reply

    def dismiss(self) -> None:
        """Let its supervisor end it."""
        if self._lifeline is not None:
            os.close(self._lifeline)
            self._lifeline = None

    def end(self) -> None:
        """End it, and every process that it has started."""
        self.dismiss()
        try:
            self._supervisor.wait(END_SECONDS)
        except subprocess.TimeoutExpired:
            self._supervisor.kill()
            self._supervisor.wait()
        if self._thread is not None:
            self._thread.join(END_SECONDS)
        self._connection.close()

    def _exchange(self, message: bytes) -> None:
        """Send a batch and wait for the reply, in a thread: a worker may be stopped in the middle of a message."""
        with suppress(Exception):  # it has died, or its engine has written into the connection
            self._connection.send_bytes(message)
            while (reply := self._connection.recv()) == BEGUN:
                self._begun, self.deadline = True, time.monotonic() + self._limit + GRACE_SECONDS
                self._news.put(None)
            self._reply = reply
        self._silent = True
        self._news.put(None)

    def _death(self) -> WorkerDied:
        """End it, and say why its batch has no results."""
        late = time.monotonic() > self.deadline
        self.end()
        crash_log = self._crash_log.read_text(errors="replace") if self._crash_log.exists() else ""
        reason = reason_of_death(crash_log, self._limit)
        if reason is None and late and self._begun:
            reason = limit_reached(self._limit)
        if reason is not None:
            return WorkerDied(reason, by_engine=True)
        return WorkerDied(f"no worker process started within {START_SECONDS:g} s" if late else KILLED)
