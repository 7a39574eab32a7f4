"""An engine for another Python that does what engines do at their worst; served by engines/isolated/worker.py."""

import contextlib
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
    }


class EngineLane:
    """A mass without springs that does, in every run, what ``trouble`` says."""

    def __init__(self, parameters: dict[str, Any]):
        self._trouble = str(parameters["trouble"])

    def run(self, position: Any, velocity: Any, loads: Any, record: bool) -> dict[str, Any]:
        TROUBLES[self._trouble]()
        motion = np.cumsum(np.vstack([position, *[velocity] * len(loads)]), axis=0)[1:]
        return {
            "position": motion,
            "velocity": np.tile(velocity, (len(loads), 1)),
            "friction": np.zeros((len(loads), position.size // 2)),
        }


def _crash() -> None:
    print("about to read nowhere", flush=True)
    ctypes.string_at(0)


def _raise() -> None:
    raise ArithmeticError("the solver lost its way")


def _print() -> None:
    print(20_000 * "Warning : something in the solution of something\n")


def _write(text: bytes) -> None:
    for descriptor in range(3, 20):
        with contextlib.suppress(OSError):
            os.write(descriptor, text)


def _half() -> None:
    """Announce ten bytes, give three, and end."""
    _write((10).to_bytes(8, "little") + b"abc")
    os._exit(0)


TROUBLES = {
    "none": lambda: None,
    "crash": _crash,
    "exit": lambda: os._exit(3),
    "leave": lambda: sys.exit("no licence"),
    "hang": lambda: ctypes.PyDLL(None).sleep(1000),  # with the interpreter's lock held, as compiled code does
    "raise": _raise,
    "print": _print,
    "garble": lambda: _write(b"Warning : something else"),
    "half": _half,
}
