"""The compiled reading of modes: what time step and residual do not resolve is left out."""

from typing import Any

import numba
import numpy as np

SHORTEST_STICK = 2
"""Steps that a stick lasts at least; one of a single step is a reversal of the slip.

Where the relative velocity changes its sign, the scheme ends the step in between at rest whether or
not the contact would have stuck: a stick shorter than two steps is not resolved.
"""


@numba.njit(cache=True, error_model="numpy")
def resolve(modes: Any, travel: Any, rubs: Any, shortest: float) -> None:
    """Leave out of every column, in place, the sticks and the slips that the step and the residual do not resolve."""
    for cell in range(modes.shape[1]):
        column = modes[:, cell].copy()
        _drop_short_sticks(column)
        if rubs[cell]:
            _drop_short_slips(column, travel[:, cell], shortest)
        modes[:, cell] = column


@numba.njit(cache=True, error_model="numpy")
def _drop_short_sticks(column: Any) -> None:
    """Turn sticks of fewer than `SHORTEST_STICK` steps into the slip that follows, in place."""
    before = column.copy()
    starts = _starts(before)
    for phase in range(starts.size):
        first, following = starts[phase], starts[(phase + 1) % starts.size]
        length = (following - first - 1) % column.size + 1
        if before[first] == 0 and length < SHORTEST_STICK:
            for k in range(first, first + length):
                column[k % column.size] = before[following]


@numba.njit(cache=True, error_model="numpy")
def _drop_short_slips(column: Any, travel: Any, shortest: float) -> None:
    """Turn slips into stick that travel less than `shortest` [m], in place."""
    starts = _starts(column)
    for phase in range(starts.size):
        first, following = starts[phase], starts[(phase + 1) % starts.size]
        length = (following - first - 1) % column.size + 1
        if column[first] == 0:
            continue
        way = 0.0
        for k in range(first, first + length):
            way += travel[k % column.size]
        if abs(way) < shortest:
            for k in range(first, first + length):
                column[k % column.size] = 0


@numba.njit(cache=True, error_model="numpy")
def _starts(column: Any) -> Any:
    """First steps of the uninterrupted modes of a cyclic period; none if the mode never changes."""
    starts = np.empty(column.size, dtype=np.int64)
    count = 0
    for k in range(column.size):
        if column[k] != column[k - 1]:
            starts[count] = k
            count += 1
    return starts[:count]
