"""Engines that prepare themselves before their first run, and where that goes wrong."""

import ctypes
import os
import time
from pathlib import Path

from multibody_xval.engines import Preparation
from tests.wrong_engines.faulty import Faulty

SLOW_SECONDS = 6.0
"""Longer than what a test allows its batches, and than an engine may take without a word."""


def noted() -> None:
    """Write down that an engine is being prepared, where a test looks for it."""
    if "FAULTY_PREPARED" in os.environ:
        with Path(os.environ["FAULTY_PREPARED"]).open("a") as file:
            file.write("prepared\n")


class NeverReady(Faulty):
    """Waits in compiled code, and lets no other thread of Python run."""

    name = "faulty-never-ready"
    preparation = Preparation("compiles nothing", 2.0)

    def prepare(self, cells, formulation, preset):
        noted()
        ctypes.PyDLL(None).sleep(10_000)


class SlowlyReady(Faulty):
    """Takes longer to be ready than its batches may take, within the limit that it names."""

    name = "faulty-slowly-ready"
    preparation = Preparation("compiles its kernels", 60.0)

    def prepare(self, cells, formulation, preset):
        noted()
        time.sleep(SLOW_SECONDS)
        super().prepare(cells, formulation, preset)


class NeedsACompiler(Faulty):
    """Finds no compiler."""

    name = "faulty-compiler"
    preparation = Preparation("compiles its kernels", 60.0)

    def prepare(self, cells, formulation, preset):
        noted()
        raise RuntimeError("no compiler")


class CrashesEarly(Faulty):
    """Reads where there is no memory, before its first run."""

    name = "faulty-early"
    preparation = Preparation("compiles its kernels", 60.0)

    def prepare(self, cells, formulation, preset):
        noted()
        ctypes.string_at(0)
