"""Faults that take their process along, or would take that of the client: at the frequency ratio `DEADLY` only."""

import contextlib
import ctypes
import faulthandler
import os
import resource
import signal
import sys
import threading
import time
from collections.abc import Callable, Mapping
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


def at_the_deadly_point(act: Callable[[], object], *, once: bool = False) -> Callable[..., State]:
    """Act in every run there, or in the first."""

    def around(batch: Batch, state: State, start: int, steps: int, rows: Rows) -> State:
        if is_deadly(batch) and not (once and batch.memory.setdefault("acted", False)):
            batch.memory["acted"] = True
            act()
        return batch.advanced(state, start, steps, rows)

    return around


def hang() -> None:
    """Wait in compiled code, and let no other thread of Python run."""
    ctypes.PyDLL(None).sleep(FOR_EVER)


def disarm() -> None:
    faulthandler.cancel_dump_traceback_later()
    hang()


def kill(number: int) -> Callable[[], None]:
    return lambda: os.kill(os.getpid(), number)


def raising(problem: BaseException) -> Callable[[], None]:
    def act() -> None:
        raise problem

    return act


class UnspeakableError(Exception):
    """Fails when it is asked what it says."""

    def __str__(self) -> str:
        raise RuntimeError("no words")


def eat() -> None:
    """Take all memory that there is, here 2 GiB."""
    resource.setrlimit(resource.RLIMIT_AS, (2**31, resource.RLIM_INFINITY))
    np.ones(2**40)


def garble() -> None:
    for descriptor in Path("/proc/self/fd").iterdir():
        with contextlib.suppress(OSError):
            if str(descriptor.readlink()).startswith("pipe"):
                os.write(int(descriptor.name), 100 * b"what an engine says")


def stop_while_sending() -> None:
    def send_a_part(connection: Connection, data: bytes) -> None:
        os.write(connection.fileno(), data[:100])
        os.kill(os.getpid(), signal.SIGSTOP)

    Connection._send = send_a_part


def fork() -> None:
    """Leave a child behind that sleeps, and go on in a copy of the process too."""
    sleeper = os.fork()
    if sleeper == 0:
        time.sleep(FOR_EVER)
    if "FAULTY_CHILD" in os.environ:
        Path(os.environ["FAULTY_CHILD"]).write_text(str(sleeper))
    os.fork()


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


def change_numpy(_batch: Batch) -> None:
    sine = np.sin
    np.sin = lambda values: 0.5 * sine(values)


def read_nowhere(_batch: Batch, _state: State, _start: int, _steps: int, _rows: Rows) -> State:
    ctypes.string_at(0)
    raise AssertionError("the process goes on")


def dies(what: str, act: Callable[[], object], *, once: bool = False) -> Fault:
    return Fault(what, around=at_the_deadly_point(act, once=once))


PROCESSES: Mapping[str, Fault] = {
    "crash": dies("a read where there is no memory", lambda: ctypes.string_at(0)),
    "dies": Fault("a read where there is no memory, always", around=read_nowhere),
    "hang": dies("an endless wait in compiled code", hang),
    "disarms": dies("an endless wait without the process's alarm", disarm),
    "stopped": dies("a process that is stopped", kill(signal.SIGSTOP)),
    "killed": dies("a process that is killed", kill(signal.SIGKILL)),
    "exits": dies("an exit", lambda: sys.exit(0)),
    "leaves": dies("an exit without a word to Python", lambda: os._exit(0)),
    "hungry": dies("all memory taken", eat),
    "garbles": dies("rubbish in every pipe", garble),
    "sending": dies("a process that is stopped while it sends", stop_while_sending),
    "interrupts": dies("what Ctrl-C raises", raising(KeyboardInterrupt())),
    "unspeakable": dies("an error that cannot be printed", raising(UnspeakableError())),
    "mumbles": dies("an error with a byte that is no UTF-8", raising(OSError("no file \udc80\x1b[2J"))),
    "forks": dies("a copy of the process", fork, once=True),
    "thread": dies("a thread that never ends", leave_a_thread),
    "flood": dies("a hundred megabytes of output", flood, once=True),
    "daemon": dies("a process of its own", leave_a_daemon),
    "changes": Fault("a function of NumPy is replaced", batch=change_numpy),
}
"""Engines whose motion is sound, until they are asked at the deadly point."""
