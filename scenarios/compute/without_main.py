"""Processes that import nothing of the main program: a script that computes needs no guard."""

import sys
from multiprocessing.context import ForkServerContext, ForkServerProcess
from multiprocessing.popen_forkserver import Popen
from types import ModuleType
from typing import Any


class _Start(Popen):
    def _launch(self, process: Any) -> None:
        main = sys.modules["__main__"]
        sys.modules["__main__"] = ModuleType("__main__")
        try:
            super()._launch(process)  # type: ignore[misc]
        finally:
            sys.modules["__main__"] = main


class _Process(ForkServerProcess):
    _Popen = staticmethod(_Start)


class WithoutMain(ForkServerContext):
    """Forks processes from one that has loaded what they need."""

    Process = _Process
