"""What a terminal is told of the first compilation."""

import sys
from functools import cache
from typing import Any

NOTICE = "compiling the solvers for this machine: this takes up to half a minute, once; they are kept for later runs"
"""Said once, before results."""


@cache
def announce_compilation() -> None:
    """Say it in a terminal when the suite has to be compiled, once; commands call this before they compute."""
    if not sys.stderr.isatty():
        return
    from numba.core import event as compiler

    class Notice(compiler.Listener):  # type: ignore[misc]
        said = False

        def on_start(self, event: Any) -> None:
            package = str(event.data["dispatcher"].py_func.__module__).partition(".")[0]
            if not self.said and package in ("reference_lcp", "multibody_xval"):
                self.said = True
                print(NOTICE, file=sys.stderr, flush=True)

        def on_end(self, event: Any) -> None:
            """Nothing is said at the end: results follow."""

    compiler.register("numba:compile", Notice())
