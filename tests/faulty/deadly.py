"""Faults that take their process along, or would take that of the client: at the frequency ratio `DEADLY` only."""

import ctypes
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Mapping
from functools import partial
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np

from reference_lcp.chain.trajectory import State
from tests.faulty.scheme import Batch, Fault, Rows

DEADLY = 0.5

FOR_EVER = 10_000


def is_deadly(batch: Batch) -> bool:
    """Whether a chain is driven at `DEADLY`."""
    driven = [(own, getattr(own.drive, "angular_frequency", np.nan)) for own in batch.lanes]
    return any(abs(omega / own.chain.resonator_frequency - DEADLY) < 1e-9 for own, omega in driven)


def dies(what: str, act: Callable[[], object], *, once: bool = False, always: bool = False) -> Fault:
    """Act in every run at the deadly point, in the first one, or anywhere."""

    def around(batch: Batch, state: State, start: int, steps: int, rows: Rows) -> State:
        if (always or is_deadly(batch)) and not (once and batch.memory.setdefault("acted", False)):
            batch.memory["acted"] = True
            act()
        return batch.advanced(state, start, steps, rows)

    return Fault(what, around=around)


def end_by(number: int) -> None:
    os.kill(os.getpid(), number)


def raising(problem: BaseException) -> Callable[[], None]:
    def act() -> None:
        raise problem

    return act


class UnspeakableError(Exception):
    """Fails when it is asked what it says."""

    def __str__(self) -> str:
        raise RuntimeError("no words")


def stop_while_sending() -> None:
    def send_a_part(connection: Connection, data: bytes) -> None:
        os.write(connection.fileno(), data[:100])
        end_by(signal.SIGSTOP)

    Connection._send = send_a_part


def leave_a_daemon() -> None:
    """Leave a process behind with a session of its own and no parent; its number is in a file."""
    file = Path(os.environ["FAULTY_CHILD"])
    if not file.exists() and os.fork() == 0:
        os.setsid()
        daemon = os.fork()
        if daemon == 0:
            time.sleep(FOR_EVER)
        file.write_text(str(daemon))
        os._exit(0)


def leave_a_thread() -> None:
    """Leave a thread behind that never ends, and that Python waits for at its end."""
    threading.Thread(target=time.sleep, args=(FOR_EVER,)).start()


def flood() -> None:
    for _ in range(100):
        sys.__stdout__.write(1_000_000 * "~")
    sys.__stdout__.flush()


PROCESSES: Mapping[str, Fault] = {
    "crash": dies("a read where there is no memory", partial(ctypes.string_at, 0)),
    "dies": dies("a read where there is no memory, always", partial(ctypes.string_at, 0), always=True),
    "hang": dies("an endless wait in compiled code", partial(ctypes.PyDLL(None).sleep, FOR_EVER)),
    "stopped": dies("a process that is stopped", partial(end_by, signal.SIGSTOP)),
    "killed": dies("a process that is killed", partial(end_by, signal.SIGKILL)),
    "exits": dies("an exit", sys.exit),
    "leaves": dies("an exit without a word to Python", partial(os._exit, 0)),
    "sending": dies("a process that is stopped while it sends", stop_while_sending),
    "interrupts": dies("what Ctrl-C raises", raising(KeyboardInterrupt())),
    "unspeakable": dies("an error that cannot be printed", raising(UnspeakableError())),
    "mumbles": dies("an error with a byte that is no UTF-8", raising(OSError("no file \udc80\x1b[2J"))),
    "forks": dies("a copy of the process", os.fork, once=True),
    "thread": dies("a thread that never ends", leave_a_thread),
    "flood": dies("a hundred megabytes of output", flood, once=True),
    "daemon": dies("a process of its own", leave_a_daemon),
}
"""Engines whose motion is sound, until they are asked at the deadly point."""
