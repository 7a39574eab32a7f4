"""How the process of a command begins and ends.

Ctrl-C ends a command within two seconds, with one line and its exit code, also while its modules are imported. With
``python -m``, what lies in the working folder is not taken for the suite. This module imports little but the standard
library: a command calls `heed_interrupts` and `refuse_shadows` before it imports anything else.
"""

import importlib.util
import os
import select
import signal
import socket
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Thread

from reference_lcp.errors import ExitCode

CLOSE_SECONDS = 1.5
"""What a command has to close what it holds; then it ends as it is. Stores and outputs bear that."""


PACKAGES = ("reference_lcp", "engines", "scenarios", "reports")
"""What the suite imports of itself."""

ROOT = Path(__file__).resolve().parents[1]


class _State:
    """What Ctrl-C does in this process."""

    watched = False
    seconds = 0.0
    pending = False
    announced = False


def heed_interrupts() -> None:
    """Let Ctrl-C end this process at once, and in `closing_on_interrupt` after a moment to close.

    A thread waits for the signal, so that the main thread need not come to it. Where Ctrl-C is ignored, as in a shell's
    background jobs, or somebody else's, it stays so.
    """
    if _State.watched or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        return
    _State.watched = True
    reader, writer = socket.socketpair()  # Windows waits for sockets only
    writer.setblocking(False)
    signal.set_wakeup_fd(writer.detach(), warn_on_full_buffer=False)
    signal.signal(signal.SIGINT, _pass)
    Thread(target=_end_process, args=(reader,), daemon=True).start()


@contextmanager
def closing_on_interrupt() -> Iterator[None]:
    """Let Ctrl-C raise `KeyboardInterrupt` here; a second one, or the end of `CLOSE_SECONDS`, ends the process."""
    _State.announced = False
    if not _State.watched:
        yield
        return
    _State.seconds = CLOSE_SECONDS
    signal.signal(signal.SIGINT, _raise)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, _pass)
        if not _State.pending:
            _State.seconds = 0.0


def interrupt_pending() -> bool:
    """Whether Ctrl-C was raised in `closing_on_interrupt`, whatever has become of the exception."""
    return _State.pending


def announce_interrupt(message: str) -> None:
    """Tell the user in one line that the command is interrupted; once."""
    if not _State.announced:
        _State.announced = True
        print(message, file=sys.stderr, flush=True)


def end_interrupted() -> None:
    """End an interrupted command that has closed what it holds, without Python's own end, which takes seconds."""
    if _State.watched:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(ExitCode.INTERRUPTED)


def _pass(_signal: int, _frame: object) -> None:
    """Leave the signal to the thread."""


def _raise(_signal: int, _frame: object) -> None:
    _State.pending = True
    signal.signal(signal.SIGINT, _pass)  # the second one is for the thread
    raise KeyboardInterrupt


def _end_process(reader: socket.socket) -> None:
    """End this process at the first Ctrl-C, or so long after it, or at the second one."""
    _wait_for_interrupt(reader, None)
    _wait_for_interrupt(reader, _State.seconds)
    if not _State.announced:
        os.write(2, b"error: interrupted\n")
    os._exit(ExitCode.INTERRUPTED)


def _wait_for_interrupt(reader: socket.socket, seconds: float | None) -> None:
    """Return at the next Ctrl-C, or after so many seconds; other signals are passed over."""
    end = None if seconds is None else time.monotonic() + seconds
    while select.select([reader], [], [], None if end is None else max(0.0, end - time.monotonic()))[0]:
        if signal.SIGINT in reader.recv(1):
            return


def refuse_shadows() -> None:
    """End a command of ``python -m`` where a package of the suite is hidden by something of the working folder.

    Nothing can be said where it is the package itself that ``python -m`` names: then Python runs what hides it.
    """
    for name in PACKAGES:
        spec = importlib.util.find_spec(name)
        origin = None if spec is None else spec.origin
        if origin is not None and Path(origin).resolve() != ROOT / name / "__init__.py":
            print(
                f"error: {origin} hides the package {name} of the suite; allowed: the command multibody-xval, which "
                "does not look into the working folder, or another folder",
                file=sys.stderr,
            )
            raise SystemExit(ExitCode.WRONG_INPUT)
