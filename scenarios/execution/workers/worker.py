"""A worker process: runs the batches that come through its connection, and gives their results."""

import faulthandler
import os
import pickle
import re
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection
from pathlib import Path
from typing import IO, Any

from engines.out_of_process.crash_log import FATAL, place_of_crash
from scenarios.execution.computation.batch import run_batch
from scenarios.execution.computation.failures import WORKER_MARK
from scenarios.execution.workers.identity import identity_of, mismatch_reason
from scenarios.execution.workers.preparation import Preparations, Preparing
from scenarios.tasks.result import Result

BEGUN = "begun"
"""Message of a worker that begins with a batch: from then on the time limit counts."""


def serve(descriptor: int, crash_log: str) -> None:
    """Run batches until the connection is closed.

    Parameters
    ----------
    descriptor
        Of the connection, through which batches come, pickled with the identity of their variant, see `identity_of`,
        and the time limit [s]. `BEGUN` goes back for each; `Preparing`, and `BEGUN` again, where its engine is prepared
        first; then the results, or the reason why there are none.
    crash_log
        File into which the process writes where it was when it crashed or passed the time limit.
    """
    os.environ[WORKER_MARK] = "1"
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    connection = Connection(descriptor)
    with Path(crash_log).open("w") as file, suppress(EOFError, OSError):  # the client has gone
        faulthandler.enable(file, all_threads=False)
        _Server(connection, file).run()


class _Server:
    """The worker's end of the connection."""

    def __init__(self, connection: Connection, crash_log: IO[str]):
        self._connection, self._crash_log = connection, crash_log
        self._process = os.getpid()
        self._preparations = Preparations(self._prepare)

    def run(self) -> None:
        """Reply to one batch after the other."""
        while True:
            message = self._connection.recv_bytes()
            self._send(BEGUN)
            self._send(self._reply(message))

    def _send(self, message: Any) -> None:
        if os.getpid() != self._process:  # an engine has forked, and this is the copy
            os._exit(0)
        self._connection.send(message)

    def _reply(self, message: bytes) -> list[Result] | str:
        try:
            batch, identity, limit = pickle.loads(message)
        except Exception as problem:  # such as a drive whose class this process cannot import
            return f"the task cannot be read in a worker process: {type(problem).__name__}: {problem}"
        with _ended_after(limit, self._crash_log):
            reason = mismatch_reason(identity_of(batch[0].variant), identity)
        if reason is None:
            reason = self._preparations.problem(batch[0].variant, batch[0].ratios.cells)
        if reason is not None:
            return reason
        self._send(BEGUN)
        with _ended_after(limit, self._crash_log):
            return run_batch(batch)

    def _prepare(self, preparing: Preparing, prepare: Callable[[], object]) -> None:
        self._send(preparing)
        with _ended_after(preparing.limit, self._crash_log):
            prepare()


@contextmanager
def _ended_after(limit: float, crash_log: IO[str]) -> Iterator[None]:
    """End the process after `limit` seconds, and write down where it was.

    The limit holds inside compiled code too, whether or not it lets other threads of Python run.
    """
    faulthandler.dump_traceback_later(limit, exit=True, file=crash_log)
    try:
        yield
    finally:
        faulthandler.cancel_dump_traceback_later()


def reason_of_death(crash_log: str, limit: float) -> str | None:
    """Read from its crash log why a worker has ended; ``None`` if it has left nothing."""
    where = place_of_crash(crash_log)
    if crash_log.startswith("Timeout"):
        return f"{limit_reached(limit)}{where}"
    fault = re.search(rf"{FATAL}(.+)", crash_log)
    return f"the worker process crashed: {fault[1]}{where}" if fault else None


def limit_reached(limit: float) -> str:
    """Give the reason of a batch that took too long."""
    return f"stopped at the time limit of {limit:g} s"
