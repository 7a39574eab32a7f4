"""A worker process: runs the batches that come through its connection, and gives their results."""

import faulthandler
import os
import pickle
import re
import signal
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path
from typing import IO

from engines.out_of_process.crash_log import FATAL, place_of_crash
from scenarios.execution.batch import Batch, run_batch
from scenarios.execution.failures import WORKER_MARK
from scenarios.execution.identity import identity_of, mismatch_reason
from scenarios.tasks.result import Result

BEGUN = "begun"
"""Message of a worker that begins a batch: from then on the time limit counts."""


def serve(descriptor: int, crash_log: str) -> None:
    """Run batches until the connection is closed.

    Parameters
    ----------
    descriptor
        Of the connection, through which pickled arguments of `run_within` come: batch, identity, time limit [s].
        `BEGUN` goes back for each, then the results, or the reason why the batch could not be read.
    crash_log
        File into which the process writes where it was when it crashed or passed the time limit.
    """
    os.environ[WORKER_MARK] = "1"
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    connection, own = Connection(descriptor), os.getpid()
    with Path(crash_log).open("w") as file, suppress(EOFError, OSError):  # the client has gone
        faulthandler.enable(file, all_threads=False)
        while True:
            message = connection.recv_bytes()
            connection.send(BEGUN)
            reply = _reply(message, file)
            if os.getpid() != own:  # an engine has forked, and this is the copy
                os._exit(0)
            connection.send(reply)


def _reply(message: bytes, crash_log: IO[str]) -> list[Result] | str:
    try:
        batch, identity, limit = pickle.loads(message)
    except Exception as problem:  # such as a drive whose class this process cannot import
        return f"the task cannot be read in a worker process: {type(problem).__name__}: {problem}"
    return run_within(batch, identity, limit, crash_log)


def run_within(batch: Batch, identity: str, limit: float, crash_log: IO[str]) -> list[Result]:
    """Run a batch, or end the process after `limit` seconds and write down where it was.

    The limit holds inside compiled code too, whether or not it lets other threads of Python run. Where the variant has
    another identity here than at the client, see `identity_of`, every task is blocked.
    """
    faulthandler.dump_traceback_later(limit, exit=True, file=crash_log)
    try:
        reason = mismatch_reason(identity_of(batch[0].variant), identity)
        return run_batch(batch) if reason is None else [Result.blocked(reason)] * len(batch)
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
