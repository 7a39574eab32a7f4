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

from engines.shared.worlds import CHUNK, Rows, Worlds
from reference_lcp.validation import FloatArray

SIZES = (1, 8, 64)
"""Numbers of worlds for which steps are compiled; fewer are filled up, and above the last its multiples are taken.

Compiling takes seconds for every size, and the lanes of a search for steady states become fewer one by one.
"""


def size_of(worlds: int) -> int:
    """Give the number of worlds that is compiled for, to hold so many."""
    return next((size for size in SIZES if size >= worlds), -(-worlds // SIZES[-1]) * SIZES[-1])


def batched_model(models: Sequence[Any]) -> tuple[Any, Any]:
    """Give one model in which every number has a row a world, filled up with the last one, and data of one world.

    Whatever the numbers, models of one structure share what has been compiled for any of them.
    """
    import jax
    from mujoco import mjx

    put = [_model(model) for model in models]
    put += put[-1:] * (size_of(len(models)) - len(models))
    columns = zip(*(jax.tree.leaves(each) for each in put), strict=True)
    rows = [jax.device_put(np.stack(column)) for column in columns]
    return jax.tree.unflatten(jax.tree.structure(put[0]), rows), mjx.make_data(put[0])


def _model(model: Any) -> Any:
    """Put a model into MJX: all inner masses have friction, be it none now and then; nothing but arrays differs."""
    from mujoco import mjx

    rubs = np.zeros(model.nv, dtype=bool)
    rubs[1::2] = True
    # Sizes of geometries beside height fields, of which there are none, would be a part of the structure.
    no_sizes = np.zeros(model.ngeom)
    return mjx.put_model(model).tree_replace({"_impl.dof_hasfrictionloss": rubs, "_impl.geom_rbound_hfield": no_sizes})


ONE_THREAD = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
"""What keeps JAX's calculations on one thread: the suite runs processes side by side."""

COMPILED = "compiled"
"""Folder of the environment that keeps what has been compiled there, until the environment is made anew."""


class MJXWorlds(Worlds):
    """Worlds of one structure, with one control each, that take their steps together.

    The bounds of friction are set before each step, `modulated` or not.
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
        import jax

        state = (self._filled(positions), self._filled(velocities), self._filled(np.zeros(velocities.shape)))
        # Where steps leave theirs: for a state that is on no device yet, all would be compiled once more.
        self._state = jax.device_put(state, jax.devices()[0])

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
