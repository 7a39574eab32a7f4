"""A worker process on this machine, as its client sees it."""

import math
import os
import pickle
import select
import signal
import time
from contextlib import suppress
from pathlib import Path
from queue import SimpleQueue
from threading import Thread

from reference_lcp.compilation import say_in_terminal
from scenarios.execution.computation.batch import Batch
from scenarios.execution.executor import KILLED, WorkerDied
from scenarios.execution.workers.preparation import KEPT_SECONDS, Preparing
from scenarios.execution.workers.worker import BEGUN, limit_reached, reason_of_death
from scenarios.execution.workers.worker_template import END_SECONDS, START_SECONDS, WorkerTemplate
from scenarios.tasks.result import Result

GRACE_SECONDS = 1.0
"""By how much a process may pass the time limit, in which it writes its crash log."""


class LocalWorker:
    """A process forked from a template, below a supervisor, which runs one batch at a time.

    It does not import the program that started it, and no Ctrl-C of the terminal reaches it. When the starting process
    ends, so does it, with every process that an engine has started in it; see `scenarios.execution.workers.supervisor`.

    Parameters
    ----------
    engine
        The only one whose batches it is given: what an engine does to its process affects no other engine.
    template
        From which it is forked.
    crash_log
        File into which it writes where it crashed.
    news
        Gets an item whenever `finished` and `deadline` have to be looked at anew.

    Raises
    ------
    ExecutorError
        If no process can be started.
    """

    def __init__(self, engine: str, template: WorkerTemplate, crash_log: Path, news: "SimpleQueue[None]"):
        self.engine = engine
        self.deadline = math.inf
        self.busy = False
        self._crash_log = crash_log
        self._news = news
        self._limit = math.inf
        self._preparing: Preparing | None = None
        self._begun = self._silent = False
        self._reply: list[Result] | str | None = None
        self._size = 0
        self._thread: Thread | None = None
        self._lifeline: int | None
        self._connection, self._lifeline, self._supervisor = template.fork(crash_log)

    def alive(self) -> bool:
        """Whether it would take a batch."""
        return not self._ended(0.0)

    def run(self, batch: Batch, identity: str, limit: float) -> None:
        """Start on a batch, see `scenarios.execution.workers.worker.serve`, that may take `limit` seconds."""
        self.busy, self._size, self._limit = True, len(batch), limit
        self._begun, self._silent, self._reply, self._preparing = False, False, None, None
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
        if self._connection.closed:  # it has been ended before
            return
        if not self._ended(END_SECONDS):
            signal.pidfd_send_signal(self._supervisor, signal.SIGKILL)
            self._ended(None)
        if self._thread is not None:
            self._thread.join(END_SECONDS)
        self._connection.close()
        os.close(self._supervisor)

    def _ended(self, within: float | None) -> bool:
        """Whether its supervisor ends within so many seconds; without a number, wait until it has."""
        end = select.poll()
        end.register(self._supervisor, select.POLLIN)
        return bool(end.poll(None if within is None else 1000 * within))

    def _exchange(self, message: bytes) -> None:
        """Send a batch and wait for the reply, in a thread: a worker may be stopped in the middle of a message."""
        with suppress(Exception):  # it has died, or its engine has written into the connection
            self._connection.send_bytes(message)
            while (reply := self._connection.recv()) == BEGUN or isinstance(reply, Preparing):
                self._note(reply)
            self._reply = reply
        self._silent = True
        self._news.put(None)

    def _note(self, begun: Preparing | str) -> None:
        """Let the limit of what has begun count, and say it if an engine has to prepare itself for long."""
        self._preparing = begun if isinstance(begun, Preparing) else None
        limit = self._limit if self._preparing is None else self._preparing.limit
        self._begun, self.deadline = True, time.monotonic() + limit + GRACE_SECONDS
        self._news.put(None)
        if self._preparing is not None and not self._connection.poll(KEPT_SECONDS):
            say_in_terminal(self._preparing.notice)

    def _death(self) -> WorkerDied:
        """End it, and say why its batch has no results."""
        late, preparing = time.monotonic() > self.deadline, self._preparing
        limit = self._limit if preparing is None else preparing.limit
        self.end()
        crash_log = self._crash_log.read_text(errors="replace") if self._crash_log.exists() else ""
        reason = reason_of_death(crash_log, limit)
        if reason is None and late and self._begun:
            reason = limit_reached(limit)
        if reason is not None and preparing is not None:
            return WorkerDied(f"{preparing.what}: {reason}", preparing=True)
        if reason is not None:
            return WorkerDied(reason, by_engine=True)
        return WorkerDied(f"no worker process started within {START_SECONDS:g} s" if late else KILLED)
