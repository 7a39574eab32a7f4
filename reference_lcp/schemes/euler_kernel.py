"""The kernel of equation (5): cells advance eight at a time, one in each column of a table.

A column is a run of consecutive cells. Eight lanes have a column each; where there are fewer, a lane is cut into two,
four or eight segments, so that a single chain advances eight of its cells at once. Every column does the same
operations in the same order whatever the cut: the answers are the same to the last bit. They are also the same on all
processors that multiply and add with one rounding, and on all that do not; between the two they differ by round-off.

A row of a table holds one cell of every column: eight numbers of each field, one field after the other. One table has
the state, another the parameters. Row 0 and the last row of the state belong to the neighbours at the ends of each
column: the base and the free end, or the cells of the segments before and after it. Rows beyond the end of a lane are
cells without springs and masses, which stay still. Long chains of equal cells have one row of parameters: what is not
read again and again from memory is not waited for.
"""

from typing import Any

import numba
import numpy as np

from reference_lcp.schemes.subnormals import flush_subnormals, restore
from reference_lcp.schemes.vectors import (
    WIDTH,
    after,
    before,
    chosen,
    clipped,
    gathered,
    multiply_add,
    set_vector,
    vector_at,
)

U, V, DU, DV, FRICTION = range(0, 5 * WIDTH, WIDTH)
"""Where a row of the state has u, v, u̇, v̇ and, where it is kept, λ_T of the last step."""

CHAIN_STIFFNESS, CHAIN_DAMPING, INNER_STIFFNESS, INNER_DAMPING = range(0, 4 * WIDTH, WIDTH)
PER_OUTER, PER_INNER, REDUCED_MASS, BOUND = range(4 * WIDTH, 8 * WIDTH, WIDTH)
"""The same for the parameters, from row 1 on."""

FOLLOWS, PRECEDES = 0, WIDTH
"""Where row 0 of the parameters has 1 if a segment goes on from the one before, or into the one after, else 0."""

PARAMETERS = 8
"""Parameters of a cell, in the order above; the time step is one of the lane."""

CELL = PARAMETERS * WIDTH
"""Numbers of a row of parameters."""

TILE = 64
"""Rows that are copied together into a table and out of it: they stay in the second-level cache."""

_inlined = numba.njit(inline="always", nogil=True, error_model="numpy")


@_inlined
def _pull(parameters: Any, at: int, stretch: Any, rate: Any) -> Any:
    """Force of the chain elements at the left of a cell of every column."""
    damping = vector_at(parameters, at + CHAIN_DAMPING) * rate
    return multiply_add(vector_at(parameters, at + CHAIN_STIFFNESS), stretch, damping)


@_inlined
def _pull_first(state: Any, parameters: Any, segments: int, top: int, size: int, load: Any) -> Any:
    """Force at the left of the first cells, less the load of the drive; writes what is at the right of the last ones.

    Beside the free end is a cell that moves as the last one does: nothing pulls there.
    """
    still, last = vector_at(state, U), top - size
    u, du = vector_at(state, size + U), vector_at(state, size + DU)
    left_u, left_du, right_u, right_du = still, still, vector_at(state, last + U), vector_at(state, last + DU)
    if segments > 1:
        follows, precedes = vector_at(parameters, FOLLOWS), vector_at(parameters, PRECEDES)
        left_u, left_du = chosen(follows, before(right_u), still), chosen(follows, before(right_du), still)
        right_u, right_du = chosen(precedes, after(u), right_u), chosen(precedes, after(du), right_du)
        load = chosen(follows, still, load)
    set_vector(state, top + U, right_u)
    set_vector(state, top + DU, right_du)
    return _pull(parameters, CELL, u - left_u, du - left_du) - load


@_inlined
def _step(state: Any, parameters: Any, shape: Any, load: Any, time_step: Any) -> None:
    """Equation (5), and (7) in closed form, for a cell of every column, row after row."""
    segments, rows, size, stride = shape
    top, at = (rows + 1) * size, CELL
    pull = _pull_first(state, parameters, segments, top, size, load)
    u, du = vector_at(state, size + U), vector_at(state, size + DU)
    for row in range(size, top, size):
        v, dv = vector_at(state, row + V), vector_at(state, row + DV)
        next_u, next_du = vector_at(state, row + size + U), vector_at(state, row + size + DU)
        following = _pull(parameters, at + stride, next_u - u, next_du - du)
        inner = vector_at(parameters, at + INNER_DAMPING) * (dv - du)
        inner = multiply_add(vector_at(parameters, at + INNER_STIFFNESS), v - u, inner)
        per_outer, per_inner = vector_at(parameters, at + PER_OUTER), vector_at(parameters, at + PER_INNER)
        outer_free = multiply_add(per_outer, following - pull + inner, du)
        inner_free = multiply_add(per_inner, -inner, dv)
        force = vector_at(parameters, at + REDUCED_MASS) * (outer_free - inner_free)
        force = clipped(force, vector_at(parameters, at + BOUND))
        outer_end, inner_end = multiply_add(per_outer, -force, outer_free), multiply_add(per_inner, force, inner_free)
        set_vector(state, row + U, multiply_add(time_step, outer_end, u))
        set_vector(state, row + V, multiply_add(time_step, inner_end, v))
        set_vector(state, row + DU, outer_end)
        set_vector(state, row + DV, inner_end)
        if size > FRICTION:
            set_vector(state, row + FRICTION, force)
        u, du, pull, at = next_u, next_du, following, at + stride


_called = numba.njit(
    cache=True, nogil=True, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True
)  # fmt: skip
"""Compiled for compiled callers alone."""


@_called
def _table(numbers: Any, fields: int, cut: Any, rows: int, size: int) -> Any:
    """Table of a block of lanes, at most eight columns, with so many rows of cells from row 1 on, and zeros elsewhere.

    The `numbers`, shape (lanes, 1, fields n), are those of every cell. The table begins at a cache line: no vector is
    split between two.
    """
    room = np.zeros((rows + 2) * size + WIDTH)
    ahead = -(room.ctypes.data // room.itemsize) % WIDTH
    table = room[ahead : ahead + (rows + 2) * size]
    begin, lanes, segments, length = cut
    cells = numbers.shape[2] // fields
    for tile in range(0, rows, TILE):
        for column in range(lanes * segments):
            lane, first, at = begin + column // segments, column % segments * length, size + column
            for k in range(fields):
                for row in range(tile, min(tile + TILE, rows, cells - first)):
                    table[at + row * size + k * WIDTH] = numbers[lane, 0, k * cells + first + row]
    return table


@_called
def _parameter_table(parameters: Any, cut: Any, rows: int) -> Any:
    _, lanes, segments, length = cut
    table = _table(parameters, PARAMETERS, cut, rows, CELL)
    for column in range(lanes * segments):
        segment = column % segments
        table[FOLLOWS + column] = 1.0 if segment > 0 else 0.0
        goes_on = segment + 1 < segments and (segment + 1) * length * PARAMETERS < parameters.shape[2]
        table[PRECEDES + column] = 1.0 if goes_on else 0.0
    return table


@_called
def _are_equal(parameters: Any, cut: Any) -> bool:
    """Whether the cells of each lane are equal, and fill their columns."""
    begin, lanes, segments, length = cut
    cells = parameters.shape[2] // PARAMETERS
    if segments * length > cells:
        return False
    for lane in range(begin, begin + lanes):
        for k in range(0, parameters.shape[2], cells):
            for cell in range(1, cells):
                if parameters[lane, 0, k + cell] != parameters[lane, 0, k]:
                    return False
    return True


@_called
def _copy_out(state: Any, fields: int, cut: Any, size: int, step: int, out: Any) -> None:
    """Copy four fields of all cells of a block, or five with λ_T, to one step of `out` (lanes, steps, fields n)."""
    begin, lanes, segments, length = cut
    cells = out.shape[2] // fields
    for tile in range(0, length, TILE):
        for lane in range(lanes):
            to = out[begin + lane, step]
            for segment in range(segments):
                at, first = size + lane * segments + segment, segment * length
                for row in range(tile, min(tile + TILE, length, cells - first)):
                    place, cell = at + row * size, first + row
                    to[cell], to[cells + cell] = state[place + U], state[place + V]
                    to[2 * cells + cell], to[3 * cells + cell] = state[place + DU], state[place + DV]
                    if fields > 4:
                        to[4 * cells + cell] = state[place + FRICTION]


@_called
def _set_bounds(parameters: Any, cut: Any, step: int, bounds: Any) -> None:
    begin, lanes, segments, length = cut
    for lane in range(lanes):
        for segment in range(segments):
            at, first = CELL + BOUND + lane * segments + segment, segment * length
            for row in range(min(length, bounds.shape[1] - first)):
                parameters[at + row * CELL] = bounds[step, first + row, begin + lane]


@_called
def _advance_block(
    x: Any, parameters: Any, time_step: Any, loads: Any, load_rows: Any, bounds: Any, record: Any, block: Any
) -> None:
    """Advance a block, its first lane and their number of at most eight; arguments as in `advance`."""
    first, lanes = block
    segments = WIDTH
    while segments * lanes > WIDTH:
        segments //= 2
    rows = (x.shape[2] // 4 + segments - 1) // segments
    cut, kept = (first, lanes, segments, rows), 5 if record.shape[1] > 0 else 4
    state = _table(x, 4, cut, rows, kept * WIDTH)
    one_row = bounds.shape[0] == 0 and _are_equal(parameters, cut)
    table = _parameter_table(parameters, cut, 1 if one_row else rows + 1)
    shape = segments, rows, kept * WIDTH, 0 if one_row else CELL
    places, lengths = np.empty(WIDTH, np.int64), np.empty(WIDTH)
    for column in range(WIDTH):
        lane = first + min(column // segments, lanes - 1)
        places[column], lengths[column] = load_rows[lane] * loads.shape[1], time_step[lane]
    for step in range(loads.shape[1]):
        if bounds.shape[0] > 0:
            _set_bounds(table, cut, step, bounds)
        _step(state, table, shape, gathered(loads, places, step), vector_at(lengths, 0))
        if kept > 4:
            _copy_out(state, kept, cut, kept * WIDTH, step, record)
    _copy_out(state, 4, cut, kept * WIDTH, 0, x)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def advance(x: Any, parameters: Any, time_step: Any, loads: Any, load_rows: Any, bounds: Any, record: Any) -> None:
    """Advance every lane, in place, in blocks of at most eight.

    The state `x`, shape (lanes, 1, 4n), holds u, v, u̇, v̇; `parameters` (lanes, 1, 8n) those of `PARAMETERS`;
    `load_rows` the row of each lane in `loads`, the force on cell 1 at the start of each step. `bounds` (steps, n,
    lanes) has no steps where the friction bounds of the parameters always hold; `record` (lanes, steps, 5n) receives x
    and λ_T at the end of each step, and has no steps when nothing is kept.
    """
    register = flush_subnormals()
    for first in range(0, x.shape[0], WIDTH):
        block = first, min(WIDTH, x.shape[0] - first)
        _advance_block(x, parameters, time_step, loads, load_rows, bounds, record, block)
    restore(register)
