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

WIDTH = 8
"""Columns: numbers of float64 in the widest vector register of usual processors, of 512 bits."""

U, V, DU, DV, FRICTION, PULL = range(0, 6 * WIDTH, WIDTH)
"""Where a row has u, v, u̇, v̇, λ_T of the last step, and the force of the chain element at the left of the cell."""

CHAIN_STIFFNESS, CHAIN_DAMPING, INNER_STIFFNESS, INNER_DAMPING = range(6 * WIDTH, 10 * WIDTH, WIDTH)
PER_OUTER, PER_INNER, REDUCED_MASS, BOUND, TIME_STEP = range(10 * WIDTH, 15 * WIDTH, WIDTH)
"""The same for the parameters; in row 0 the stiffness is 1 where a segment goes on from the one before, else 0."""

PARAMETERS = 8
"""Parameters of a cell, in the order above; the time step is one of the lane."""

ROW = 15 * WIDTH

TILE = 64
"""Rows that are copied together into a table and out of it: they stay in the second-level cache."""

_inlined = numba.njit(inline="always", nogil=True, error_model="numpy")


@_inlined
def _exchange(table: Any, last: int) -> None:
    """Copy the ends of the segments to where their neighbours read them; zeros where a lane begins or ends."""
    top = last + ROW
    for j in range(WIDTH):
        position, velocity = table[last + U + j - 1], table[last + DU + j - 1]
        follows = table[CHAIN_STIFFNESS + j] > 0
        table[U + j] = position if follows else 0.0
        table[DU + j] = velocity if follows else 0.0
    for j in range(WIDTH):
        position, velocity = table[ROW + U + j + 1], table[ROW + DU + j + 1]
        precedes = table[top + CHAIN_STIFFNESS + j] > 0
        table[top + U + j] = position if precedes else 0.0
        table[top + DU + j] = velocity if precedes else 0.0


@_inlined
def _pull_first(table: Any) -> None:
    """Force of the first element of each column, less the load of the drive, which row 0 has as its pull."""
    for j in range(WIDTH):
        stretch, rate = table[ROW + U + j] - table[U + j], table[ROW + DU + j] - table[DU + j]
        pull = table[ROW + CHAIN_STIFFNESS + j] * stretch + table[ROW + CHAIN_DAMPING + j] * rate
        table[ROW + PULL + j] = pull - table[PULL + j]


@_inlined
def _step_row(table: Any, row: int) -> None:
    """Equation (5), and (7) in closed form, for a cell of every column; forms the pull of the next cell on the way."""
    after = row + ROW
    for j in range(WIDTH):
        u, v, du, dv = table[row + U + j], table[row + V + j], table[row + DU + j], table[row + DV + j]
        stretch, rate = table[after + U + j] - u, table[after + DU + j] - du
        following = table[after + CHAIN_STIFFNESS + j] * stretch + table[after + CHAIN_DAMPING + j] * rate
        inner = table[row + INNER_STIFFNESS + j] * (v - u) + table[row + INNER_DAMPING + j] * (dv - du)
        outer_free = du + table[row + PER_OUTER + j] * (following - table[row + PULL + j] + inner)
        inner_free = dv - table[row + PER_INNER + j] * inner
        force, bound = table[row + REDUCED_MASS + j] * (outer_free - inner_free), table[row + BOUND + j]
        force = force if force < bound else bound
        force = force if force > -bound else -bound
        outer_end = outer_free - table[row + PER_OUTER + j] * force
        inner_end = inner_free + table[row + PER_INNER + j] * force
        table[after + PULL + j] = following
        table[row + FRICTION + j] = force
        table[row + DU + j] = outer_end
        table[row + DV + j] = inner_end
        table[row + U + j] = u + table[row + TIME_STEP + j] * outer_end
        table[row + V + j] = v + table[row + TIME_STEP + j] * inner_end


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
def _table(x: Any, parameters: Any, time_step: Any, block: Any, segments: int, rows: int) -> Any:
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
            for row in some:
                table[at + row * ROW + TIME_STEP] = time_step[lane]
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
    cells, row_of_load = parameters.shape[2], load_rows[first:]
    segments = WIDTH
    while segments * lanes > WIDTH:
        segments //= 2
    rows = (cells + segments - 1) // segments
    table = _table(x, parameters, time_step, block, segments, rows)
    for step in range(loads.shape[1]):
        if bounds.shape[0] > 0:
            _set_bounds(table, segments, rows, block, step, bounds)
        for lane in range(lanes):
            table[PULL + lane * segments] = loads[row_of_load[lane], step]
        if segments > 1:
            _exchange(table, rows * ROW)
        _pull_first(table)
        for row in range(1, rows + 1):
            _step_row(table, row * ROW)
        if record.shape[1] > 0:
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
