"""The compiled reading of modes: what time step and residual do not resolve is left out."""

from typing import Any

import numba
import numpy as np
from numba import types

SHORTEST_STICK = 2
"""Steps that a stick lasts at least: where the slip turns round, the scheme ends the step in between at rest."""

_called = numba.njit(cache=True, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
"""Compiled for compiled callers alone."""

_MATRIX = types.Array(types.float64, 2, "A", readonly=True)
"""Any array of two dimensions: what is read comes from many engines, and is compiled for once."""

_FACTORS = types.Array(types.float64, 1, "C", readonly=True)
_FLAGS = types.Array(types.bool_, 1, "C", readonly=True)
_MODES = types.int8[:, ::1]


@_called
def _starts(row: Any) -> Any:
    """First steps of the uninterrupted modes of a cyclic period; none if the mode never changes."""
    starts = np.empty(row.size, dtype=np.int64)
    count = 0
    for k in range(row.size):
        if row[k] != row[k - 1]:
            starts[count] = k
            count += 1
    return starts[:count]


@_called
def _drop_short_sticks(row: Any) -> None:
    """Turn sticks of fewer than `SHORTEST_STICK` steps into the slip that follows, in place."""
    starts = _starts(row)
    for phase in range(starts.size):
        first, following = starts[phase], starts[(phase + 1) % starts.size]
        length = (following - first - 1) % row.size + 1
        if row[first] == 0 and length < SHORTEST_STICK:
            for k in range(first, first + length):
                row[k % row.size] = row[following]


@_called
def _drop_short_slips(row: Any, outer: Any, inner: Any, time_step: float, shortest: float) -> None:
    """Turn slips into stick that travel less than `shortest` [m], in place; the masses have these velocities."""
    starts = _starts(row)
    for phase in range(starts.size):
        first, following = starts[phase], starts[(phase + 1) % starts.size]
        length = (following - first - 1) % row.size + 1
        if row[first] == 0:
            continue
        way = 0.0
        for k in range(first, first + length):
            way += (inner[k % row.size] - outer[k % row.size]) * time_step
        if abs(way) < shortest:
            for k in range(first, first + length):
                row[k % row.size] = 0


@numba.njit(
    types.void(_MATRIX, _MATRIX, _FACTORS, _MATRIX, types.float64, _MODES), cache=True, error_model="numpy"
)  # fmt: skip
def read_modes(
    friction: Any, normal_force: Any, friction_coefficient: Any, velocities: Any, part: float, modes: Any
) -> None:
    """Read the mode of every contact in every step into `modes` (n, steps): stick below this part of the bound."""
    cells = modes.shape[0]
    for step in range(modes.shape[1]):
        for cell in range(cells):
            force, largest = friction[step, cell], friction_coefficient[cell] * normal_force[step, cell]
            if abs(force) < part * largest:
                modes[cell, step] = 0
            else:
                direction = -force if largest > 0 else velocities[step, cells + cell] - velocities[step, cell]
                modes[cell, step] = 1 if direction > 0 else -1 if direction < 0 else 0


@numba.njit(types.void(_MODES, _MATRIX, types.float64, _FLAGS, types.float64), cache=True, error_model="numpy")
def resolve(modes: Any, velocities: Any, time_step: float, rubs: Any, shortest: float) -> None:
    """Leave out of every row, in place, the sticks and the slips that the step and the residual do not resolve."""
    cells = modes.shape[0]
    for cell in range(cells):
        row = modes[cell]
        _drop_short_sticks(row)
        if rubs[cell]:
            _drop_short_slips(row, velocities[:, cell], velocities[:, cells + cell], time_step, shortest)
