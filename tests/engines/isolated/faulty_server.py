"""An engine for another Python that does what engines do at their worst; served by engines/isolated/worker.py."""

import ctypes
import os
import sys
from typing import Any

import numpy as np


def versions() -> dict[str, str]:
    return {
        "engine": "1.0",
        "path": os.pathsep.join(sys.path),
        "modules": " ".join(sys.modules),
        "environment": " ".join(sorted(os.environ)),
        "read": sys.stdin.read(),
    }


class EngineLane:
    """A mass without springs that does, in every run, what ``trouble`` says."""

    def __init__(self, parameters: dict[str, Any]):
        self._trouble = str(parameters["trouble"])
        self._made_by = os.getpid()
        if self._trouble == "refuse":
            raise ValueError("no spring is that stiff")

    def run(self, position: Any, velocity: Any, loads: Any, record: bool) -> dict[str, Any]:
        getattr(self, "_" + self._trouble)()
        motion = np.cumsum(np.vstack([position, *[velocity] * len(loads)]), axis=0)[1:]
        return {
            "position": motion,
            "velocity": np.tile(velocity, (len(loads), 1)),
            "friction": np.zeros((len(loads), position.size // 2)),
            "process": self._made_by,
        }

    def _none(self) -> None:
        return

    def _crash(self) -> None:
        print("about to read nowhere", flush=True)
        ctypes.string_at(0)

    def _exit(self) -> None:
        os._exit(3)

    def _hang(self) -> None:
        # With the lock of the interpreter held, as compiled code of an engine does.
        ctypes.PyDLL(None).sleep(1000)

    def _raise(self) -> None:
        raise ArithmeticError("the solver lost its way")

    def _leave(self) -> None:
        sys.exit("no licence")

    def _mumble(self) -> None:
        raise ArithmeticError("no file \udc80\n\x1b[2J")

    def _print(self) -> None:
        for _ in range(20_000):
            print("Warning : something in the solution of something")

    def _garble(self) -> None:
        for descriptor in range(3, 20):
            try:
                os.write(descriptor, b"Warning : something else")
            except OSError:
                continue

    def _half(self) -> None:
        """Announce ten bytes, give three, and end."""
        for descriptor in range(3, 20):
            try:
                os.write(descriptor, (10).to_bytes(8, "little") + b"abc")
            except OSError:
                continue
        os._exit(0)
