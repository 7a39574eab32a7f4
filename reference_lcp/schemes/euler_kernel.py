"""The kernel of equation (5): cells advance eight at a time, one in each column of a table.

A column is a run of consecutive cells. Eight lanes have a column each; where there are fewer, a lane is cut into two,
four or eight segments, so that a single chain advances eight of its cells at once. Every column does the same
operations in the same order whatever the cut: the answers are the same to the last bit.

A row of the table holds one cell of every column: eight numbers of each field, one field after the other. Row 0 and the
last row belong to the neighbours at the ends of each column: the base and the free end, or the cells of the segments
before and after it. Rows beyond the end of a lane are cells without springs and masses, which stay still.
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
"""Where a row has u, v, u̇, v̇ and λ_T of the last step."""

CHAIN_STIFFNESS, CHAIN_DAMPING, INNER_STIFFNESS, INNER_DAMPING = range(5 * WIDTH, 9 * WIDTH, WIDTH)
PER_OUTER, PER_INNER, REDUCED_MASS, BOUND = range(9 * WIDTH, 13 * WIDTH, WIDTH)
"""The same for the parameters; in row 0 the stiffness is 1 where a segment goes on from the one before, else 0."""

PARAMETERS = 8
"""Parameters of a cell, in the order above; the time step is one of the lane."""

ROW = 13 * WIDTH

TILE = 64
"""Rows that are copied together into a table and out of it: they stay in the second-level cache."""

_inlined = numba.njit(inline="always", nogil=True, error_model="numpy")


@_inlined
def _pull(table: Any, row: int, stretch: Any, rate: Any) -> Any:
    """Force of the chain elements at the left of a cell of every column."""
    damping = vector_at(table, row + CHAIN_DAMPING) * rate
    return multiply_add(vector_at(table, row + CHAIN_STIFFNESS), stretch, damping)


@_inlined
def _step(table: Any, rows: int, load: Any, time_step: Any, keeps: Any) -> None:
    """Equation (5), and (7) in closed form, for a cell of every column, row after row."""
    last, top = rows * ROW, (rows + 1) * ROW
    follows, precedes = vector_at(table, CHAIN_STIFFNESS), vector_at(table, top + CHAIN_STIFFNESS)
    rest = vector_at(table, U)
    u, du = vector_at(table, ROW + U), vector_at(table, ROW + DU)
    set_vector(table, top + U, chosen(precedes, after(u), rest))
    set_vector(table, top + DU, chosen(precedes, after(du), rest))
    base_u = chosen(follows, before(vector_at(table, last + U)), rest)
    base_du = chosen(follows, before(vector_at(table, last + DU)), rest)
    load = chosen(follows, rest, load)
    pull = _pull(table, ROW, u - base_u, du - base_du) - load
    for row in range(ROW, top, ROW):
        v, dv = vector_at(table, row + V), vector_at(table, row + DV)
        next_u, next_du = vector_at(table, row + ROW + U), vector_at(table, row + ROW + DU)
        following = _pull(table, row + ROW, next_u - u, next_du - du)
        inner = vector_at(table, row + INNER_DAMPING) * (dv - du)
        inner = multiply_add(vector_at(table, row + INNER_STIFFNESS), v - u, inner)
        per_outer, per_inner = vector_at(table, row + PER_OUTER), vector_at(table, row + PER_INNER)
        outer_free = multiply_add(per_outer, following - pull + inner, du)
        inner_free = multiply_add(per_inner, -inner, dv)
        force = vector_at(table, row + REDUCED_MASS) * (outer_free - inner_free)
        force = clipped(force, vector_at(table, row + BOUND))
        outer_end, inner_end = multiply_add(per_outer, -force, outer_free), multiply_add(per_inner, force, inner_free)
        set_vector(table, row + U, multiply_add(time_step, outer_end, u))
        set_vector(table, row + V, multiply_add(time_step, inner_end, v))
        set_vector(table, row + DU, outer_end)
        set_vector(table, row + DV, inner_end)
        if keeps:
            set_vector(table, row + FRICTION, force)
        u, du, pull = next_u, next_du, following


_called = numba.njit(
    cache=True, nogil=True, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True
)  # fmt: skip
"""Compiled for compiled callers alone."""


@_called
def _empty_table(rows: int) -> Any:
    """Table of so many rows of cells, all zero, that begins at a cache line: no vector is split between two."""
    room = np.zeros((rows + 2) * ROW + WIDTH)
    ahead = -(room.ctypes.data // room.itemsize) % WIDTH
    return room[ahead : ahead + (rows + 2) * ROW]


@_called
def _table(x: Any, parameters: Any, block: Any, segments: int, rows: int) -> Any:
    """Table of a block of lanes, at most eight columns; the last row has the parameters of the cell that follows."""
    table = _empty_table(rows)
    begin, lanes = block
    cells = parameters.shape[2]
    for tile in range(0, rows + 1, TILE):
        for column in range(lanes * segments):
            lane, segment = begin + column // segments, column % segments
            first, at = segment * rows, ROW + column
            some = range(tile, min(tile + TILE, rows + 1, cells - first))
            for k in range(4):
                for row in some:
                    table[at + row * ROW + k * WIDTH] = x[lane, 0, k * cells + first + row]
            for k in range(PARAMETERS):
                for row in some:
                    table[at + row * ROW + CHAIN_STIFFNESS + k * WIDTH] = parameters[lane, k, first + row]
    for column in range(lanes * segments):
        table[CHAIN_STIFFNESS + column] = 1.0 if column % segments else 0.0
    return table


@_called
def _copy_out(table: Any, segments: int, rows: int, block: Any, fields: int, cells: int, step: int, out: Any) -> None:
    """Copy the first fields of all cells of a block to `out` (lanes, steps, fields n), at one step."""
    begin, lanes = block
    for tile in range(0, rows, TILE):
        for lane in range(lanes):
            to = out[begin + lane, step]
            for k in range(fields):
                for segment in range(segments):
                    at, first = ROW + k * WIDTH + lane * segments + segment, segment * rows
                    for row in range(tile, min(tile + TILE, rows, cells - first)):
                        to[k * cells + first + row] = table[at + row * ROW]


@_called
def _set_bounds(table: Any, segments: int, rows: int, block: Any, step: int, bounds: Any) -> None:
    begin, lanes = block
    for cell in range(bounds.shape[1]):
        for lane in range(lanes):
            at = (1 + cell % rows) * ROW + lane * segments + cell // rows
            table[at + BOUND] = bounds[step, cell, begin + lane]


@_called
def _advance_block(
    x: Any, parameters: Any, time_step: Any, loads: Any, load_rows: Any, bounds: Any, record: Any, block: Any
) -> None:
    """Advance a block, its first lane and their number of at most eight; arguments as in `advance`."""
    first, lanes = block
    cells = parameters.shape[2]
    segments = WIDTH
    while segments * lanes > WIDTH:
        segments //= 2
    rows = (cells + segments - 1) // segments
    table = _table(x, parameters, block, segments, rows)
    keeps, places, lengths = record.shape[1] > 0, np.empty(WIDTH, np.int64), np.empty(WIDTH)
    for column in range(WIDTH):
        lane = first + min(column // segments, lanes - 1)
        places[column], lengths[column] = load_rows[lane] * loads.shape[1], time_step[lane]
    for step in range(loads.shape[1]):
        if bounds.shape[0] > 0:
            _set_bounds(table, segments, rows, block, step, bounds)
        _step(table, rows, gathered(loads, places, step), vector_at(lengths, 0), keeps)
        if keeps:
            _copy_out(table, segments, rows, block, 5, cells, step, record)
    _copy_out(table, segments, rows, block, 4, cells, 0, x)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def advance(x: Any, parameters: Any, time_step: Any, loads: Any, load_rows: Any, bounds: Any, record: Any) -> None:
    """Advance every lane, in place, in blocks of at most eight.

    The state `x`, shape (lanes, 1, 4n), holds u, v, u̇, v̇; `parameters` (lanes, 8, n) those of `PARAMETERS`;
    `load_rows` the row of each lane in `loads`, the force on cell 1 at the start of each step. `bounds` (steps, n,
    lanes) has no steps where the friction bounds of the parameters always hold; `record` (lanes, steps, 5n) receives x
    and λ_T at the end of each step, and has no steps when nothing is kept.
    """
    register = flush_subnormals()
    for first in range(0, x.shape[0], WIDTH):
        block = first, min(WIDTH, x.shape[0] - first)
        _advance_block(x, parameters, time_step, loads, load_rows, bounds, record, block)
    restore(register)
