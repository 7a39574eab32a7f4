"""First compilations, said in a terminal: numba compiles what a command needs when it is first called, and keeps it.

What is compiled is loaded from numba's cache from then on, until numba or the suite is another version.
"""

import sys
from typing import Any, ClassVar

SUITE = ("reference_lcp", "engines", "scenarios", "reports")
"""Packages whose functions are compiled; those of others have their own ways."""

NOTICE = "compiling the solvers for this machine: this takes up to half a minute, once; they are kept for later runs"
"""The longest that was measured for one command is a quarter of a minute, on a core that is busy with nothing else."""


def announce_compilation() -> None:
    """Say it in a terminal when something has to be compiled, once a process; commands call this before they compute.

    Output into files and pipes stays as it is.
    """
    if not sys.stderr.isatty():
        return
    from numba.core import event as compiler

    class Notice(compiler.Listener):  # type: ignore[misc]
        """Prints a line at the first compilation, and is silent from then on."""

        def on_start(self, event: Any) -> None:
            """Print the line, if the function is one of the suite."""
            if _is_of_suite(event.data["dispatcher"]):
                say_in_terminal(NOTICE)

        def on_end(self, event: Any) -> None:
            """Nothing is said at the end: results follow."""

    if not _State.listening:
        _State.listening = True
        compiler.register("numba:compile", Notice())


def say_in_terminal(line: str) -> None:
    """Print a line to standard error if that is a terminal, once a process."""
    if sys.stderr.isatty() and line not in _State.said:
        _State.said.add(line)
        print(line, file=sys.stderr, flush=True)


class _State:
    """Whether compilations are listened to, and what the user has been told."""

    listening = False
    said: ClassVar[set[str]] = set()


def _is_of_suite(dispatcher: Any) -> bool:
    return str(dispatcher.py_func.__module__).partition(".")[0] in SUITE
