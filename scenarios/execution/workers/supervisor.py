"""The parent process of a worker: whatever the worker does, nothing that it has started outlives its client.

It takes in every process that the worker leaves behind, also one with a session of its own, and ends them all as soon
as the worker has ended or the client lets go of it, which the end of the client does too. What the worker prints goes
through it, cut. It needs Linux.
"""

import ctypes
import os
import select
import signal
import time
from contextlib import suppress
from pathlib import Path

PR_SET_PDEATHSIG, PR_SET_CHILD_SUBREAPER = 1, 36
"""Options of prctl(2): a signal at the end of the parent; orphans among the descendants become children."""

PRINTED_BYTES = 10_000
"""What is shown of what a worker prints; the rest is counted. An engine that warns in every step prints gigabytes."""

CHUNK_BYTES = 4096
"""What is read and shown at a time: so much can be written to a pipe that is writable without waiting."""

POLL_SECONDS = 0.002
"""Interval at which processes that have been killed are looked for until all have ended."""


def supervise(lifeline: int, connection: int) -> None:
    """Fork: return in the child, which is the worker; stay in the parent until all that it has started has ended.

    Parameters
    ----------
    lifeline
        Descriptor of the end of a pipe whose other end the client holds open.
    connection
        Descriptor of the worker's connection with its client.
    """
    prctl(PR_SET_CHILD_SUBREAPER, 1)
    printed, output = os.pipe()
    supervisor, worker = os.getpid(), os.fork()
    if worker == 0:
        os.close(lifeline)
        os.close(printed)
        return _become_worker(supervisor, output)
    os.close(connection)
    os.close(output)
    try:
        shown = _Printed(printed)
        _watch(worker, lifeline, shown)
        _end_children()
        shown.finish()
    finally:
        os._exit(0)


def _become_worker(supervisor: int, output: int) -> None:
    """End with the supervisor, out of reach of its terminal and in a group of its own; print into its pipe."""
    prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != supervisor:  # it had ended before
        os._exit(0)
    os.setsid()
    os.dup2(output, 1)
    os.dup2(output, 2)
    os.close(output)


def prctl(option: int, value: int) -> None:
    """Set an option of this process; see prctl(2)."""
    if ctypes.CDLL(None).prctl(option, value, 0, 0, 0) != 0:
        raise OSError(f"prctl({option}, {value}) failed")


def _watch(worker: int, lifeline: int, printed: "_Printed") -> None:
    """Return when the worker has ended, or the client has closed the lifeline."""
    ended, wake = os.pipe()
    os.set_blocking(wake, False)
    signal.set_wakeup_fd(wake, warn_on_full_buffer=False)
    signal.signal(signal.SIGCHLD, lambda *_: None)
    poll = select.poll()
    for descriptor in (ended, lifeline, printed.descriptor):
        poll.register(descriptor, select.POLLIN)
    while not _has_ended(worker):
        ready = [descriptor for descriptor, _ in poll.poll()]
        if lifeline in ready:
            return
        if ended in ready:
            os.read(ended, CHUNK_BYTES)
        if printed.descriptor in ready and not printed.take():
            poll.unregister(printed.descriptor)


def _has_ended(worker: int) -> bool:
    """Read the ends of children, those of orphans too; tell whether the worker is among them."""
    with suppress(ChildProcessError):
        while (process := os.waitpid(-1, os.WNOHANG)[0]) != 0:
            if process == worker:
                return True
    return False


def _end_children() -> None:
    """Kill every child until there is none: those of a killed one become children of this process."""
    own = os.getpid()
    children = Path(f"/proc/{own}/task/{own}/children")
    while True:
        for child in children.read_text().split():
            with suppress(ProcessLookupError):
                os.kill(int(child), signal.SIGKILL)
        try:
            while os.waitpid(-1, os.WNOHANG)[0] != 0:
                pass
        except ChildProcessError:
            return
        time.sleep(POLL_SECONDS)


class _Printed:
    """What a worker prints: its beginning is shown on standard error, the rest is counted."""

    def __init__(self, descriptor: int):
        os.set_blocking(descriptor, False)
        self.descriptor = descriptor
        self._shown = self._more = 0

    def take(self) -> bool:
        """Read some of it; tell whether there was any."""
        try:
            text = os.read(self.descriptor, CHUNK_BYTES)
        except BlockingIOError:
            return False
        part = text[: PRINTED_BYTES - self._shown]
        if part:
            _show(part)
        self._shown += len(part)
        self._more += len(text) - len(part)
        return bool(text)

    def finish(self) -> None:
        """Read what is left once the worker has ended, and say how much has not been shown."""
        while self.take():
            pass
        if self._more:
            _show(f"… ({self._more} bytes more)\n".encode())


def _show(text: bytes) -> None:
    """Write to standard error, unless whoever reads it is behind: that must not hold up the supervisor."""
    with suppress(OSError):
        if select.select([], [2], [], 0)[1]:
            os.write(2, text)
