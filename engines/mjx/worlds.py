"""The worlds of one batch in MJX's memory, and JAX as the suite needs it."""

import contextlib
import functools
import importlib
import io
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from engines.mjx.model import batched_model, size_of
from engines.shared.worlds import CHUNK, Rows, Worlds
from reference_lcp.validation import FloatArray

ONE_THREAD = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
"""What keeps JAX's calculations on one thread: the suite runs processes side by side."""

COMPILED = "compiled"
"""Folder of the environment that keeps what has been compiled there, until the environment is made anew."""


class MJXWorlds(Worlds):
    """Worlds of one structure that take their steps together.

    Parameters
    ----------
    models
        A compiled `mujoco.MjModel` a world, with one control.
    modulated
        The bounds of friction in joints change from step to step; they are set before each step in either case.
    """

    def __init__(self, models: Sequence[Any], modulated: bool):
        self._compiled = import_mjx()
        self._worlds, self._columns = len(models), (int(models[0].nv), int(models[0].nsensordata))
        self._model, self._blank = batched_model(models)
        self._set(*np.zeros((2, len(models), models[0].nv)))
        self._steps(np.zeros((0, len(models))), np.zeros((0, len(models), models[0].nv // 2)))  # compiles them

    def native_steps(self, steps: int) -> None:
        """Take steps of MJX alone, from where the worlds are."""
        state = self._compiled.native_steps(self._model, self._blank, self._state, steps)
        state[0].block_until_ready()

    @property
    def _force_columns(self) -> tuple[int, int]:
        return self._columns

    def _set(self, positions: FloatArray, velocities: FloatArray) -> None:
        self._state = (self._filled(positions), self._filled(velocities), self._filled(np.zeros(velocities.shape)))

    def _steps(self, loads: FloatArray, pressing: FloatArray) -> Rows:
        self._state, record = self._compiled.recorded_steps(
            self._model, self._blank, self._state, self._chunk(loads), self._chunk(pressing), len(loads)
        )
        return Rows(*(np.array(values[: len(loads), : self._worlds]) for values in record))

    def _chunk(self, values: FloatArray) -> FloatArray:
        """Fill steps and worlds up to what is compiled for."""
        filled = self._filled(values, axis=1)
        return np.concatenate([filled, np.zeros((CHUNK - len(filled), *filled.shape[1:]))])

    def _filled(self, values: FloatArray, axis: int = 0) -> FloatArray:
        """Repeat the last world, up to the number of worlds that is compiled for."""
        indices = np.minimum(np.arange(size_of(self._worlds)), self._worlds - 1)
        return values.take(indices, axis)


@functools.cache
def import_mjx() -> Any:
    """Import what is compiled with MJX, on the processor, in double precision; it is kept beside the packages.

    Where MuJoCo Warp is missing, MJX would say so on standard output.
    """
    os.environ["XLA_FLAGS"] = ONE_THREAD
    jax = importlib.import_module("jax")
    jax.config.update("jax_enable_x64", True)
    jax.config.update("jax_platforms", "cpu")
    jax.config.update("jax_compilation_cache_dir", str(Path(sys.prefix) / COMPILED))
    with contextlib.redirect_stdout(io.StringIO()):
        return importlib.import_module("engines.mjx.steps")
