"""The entry point of ``multibody-xval``: heeds Ctrl-C before it imports anything else."""

import os
import signal
import sys
from threading import Timer

INTERRUPTED = 130
"""Exit code; shells use this number too."""

CLOSE_SECONDS = 1.5
"""What a command has to close what it holds; then it ends as it is. Stores and outputs bear that."""

_pressed: list[int] = []


def interrupted() -> bool:
    """Whether Ctrl-C was pressed, whatever has become of the exception."""
    return bool(_pressed)


def heed_interrupts() -> None:
    """Let Ctrl-C raise `KeyboardInterrupt`; a second one, or the end of `CLOSE_SECONDS`, ends the process."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _interrupt)


def _interrupt(number: int, _frame: object) -> None:
    if _pressed:
        os._exit(INTERRUPTED)
    _pressed.append(number)
    timer = Timer(CLOSE_SECONDS, os._exit, [INTERRUPTED])
    timer.daemon = True
    timer.start()
    raise KeyboardInterrupt


def main() -> None:
    """Run the command line and end with its exit code."""
    heed_interrupts()
    try:
        from multibody_xval.reports.cli.console_script import app
        from multibody_xval.reports.cli.ending import run_command

        code = run_command(app)
        _pressed.append(0)  # Ctrl-C ends the process at once from here: Python, as it ends, would print and forget it
    except BaseException:  # a module that was being imported may turn Ctrl-C into an error of its own
        if not interrupted():
            raise
        print("error: interrupted", file=sys.stderr)
        code = INTERRUPTED
    if code == INTERRUPTED:  # without Python's own end, which takes seconds
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)
    sys.exit(code)
