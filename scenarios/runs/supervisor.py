"""Ends all that a worker has started, once it or its client ends, and shows what it prints."""

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


def supervise(connection: int) -> None:
    """Fork: return in the child, the worker; in the parent, end all that it has started once it or the client ends.

    The client holds the other end of the connection.
    """
    prctl(PR_SET_CHILD_SUBREAPER, 1)
    printed, output = os.pipe()
    supervisor, worker = os.getpid(), os.fork()
    if worker == 0:
        os.close(printed)
        return _become_worker(supervisor, output)
    os.close(output)
    try:
        shown = _Printed(printed)
        _watch(worker, connection, shown)
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


def _watch(worker: int, connection: int, printed: "_Printed") -> None:
    """Return when the worker has ended, or the client has let go of the connection."""
    ended, poll = os.pidfd_open(worker), select.poll()
    poll.register(ended, select.POLLIN)
    poll.register(connection, select.POLLRDHUP)
    poll.register(printed.descriptor, select.POLLIN)
    while not {ended, connection} & {descriptor for descriptor, _ in poll.poll()}:
        if not printed.take():
            poll.unregister(printed.descriptor)


def _end_children() -> None:
    """Kill every child until there is none: those of a killed one become children of this process."""
    process = os.getpid()
    children = Path(f"/proc/{process}/task/{process}/children")
    with suppress(ChildProcessError):
        while True:
            for child in children.read_text().split():
                with suppress(ProcessLookupError):
                    os.kill(int(child), signal.SIGKILL)
            forget_ended()
            time.sleep(POLL_SECONDS)


def forget_ended() -> None:
    """Read the ends of children, whose processor time is then this process's; without any, a `ChildProcessError`."""
    while os.waitpid(-1, os.WNOHANG)[0] != 0:
        pass


class _Printed:
    """What a worker prints: its beginning is shown on standard error, the rest is counted."""

    def __init__(self, descriptor: int):
        os.set_blocking(descriptor, False)
        self.descriptor = descriptor
        self._bytes = 0

    def take(self) -> bool:
        """Read some of it; tell whether there was any."""
        try:
            text = os.read(self.descriptor, CHUNK_BYTES)
        except BlockingIOError:
            return False
        _show(text[: max(PRINTED_BYTES - self._bytes, 0)])
        self._bytes += len(text)
        return bool(text)

    def finish(self) -> None:
        """Read what is left once the worker has ended, and say how much has not been shown."""
        while self.take():
            pass
        if self._bytes > PRINTED_BYTES:
            _show(f"… ({self._bytes - PRINTED_BYTES} bytes more)\n".encode())


def _show(text: bytes) -> None:
    """Write to standard error, unless whoever reads it is behind: that must not hold up the supervisor."""
    with suppress(OSError):
        if text and select.select([], [2], [], 0)[1]:
            os.write(2, text)
