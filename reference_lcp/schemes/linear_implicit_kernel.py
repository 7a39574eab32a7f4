"""The compiled steps of `LinearImplicitLane`, and the equations of its contacts.

What is called in a step is handed few arrays, and none in a tuple: numba counts references to each, which takes longer
than the sums do. Loops stand where expressions of arrays would take twice as long to compile.
"""

from typing import Any

import numba
import numpy as np

from reference_lcp.schemes.subnormals import flush_subnormals, restore

MOST_SWEEPS = 200
"""Gauss–Seidel sweeps at most; five reach round-off where G is nearly diagonal."""

SWEPT = 1e-15
"""Largest change in a sweep, over the bound, that ends the sweeps."""


@numba.njit(inline="always", error_model="numpy")
def _impulse(slip: Any, coupling: Any, bound: Any, compliance: Any, slope: Any, smoothing: Any) -> Any:
    """Solve w = slip + coupling p, p = h φ(w), for p; see `ScalarFriction`."""
    if smoothing > 0:
        return smooth_impulse(slip, coupling, bound, smoothing)
    impulse = -slip / (coupling + compliance)
    if abs(impulse) > bound:
        size = (bound + slope * (abs(slip) - compliance * bound)) / (1 + coupling * slope)
        return -size if slip > 0 else size
    return impulse


@numba.njit(cache=True, error_model="numpy")
def smooth_impulse(slip: Any, coupling: Any, bound: Any, smoothing: Any) -> Any:
    """Solve w + coupling · bound w / √(w² + z²) = slip by Newton's method, kept in its bracket by bisection."""
    speed, most = abs(slip), coupling * bound
    low, high = 0.0, speed
    end = speed - most if speed > most else speed * smoothing / (smoothing + most)
    for _ in range(100):
        root = np.sqrt(end * end + smoothing * smoothing)
        excess = end + most * end / root - speed
        if excess > 0:
            high = end
        else:
            low = end
        following = end - excess / (1 + most * smoothing * smoothing / root**3)
        if not low < following < high:
            following = (low + high) / 2
        if abs(following - end) <= 1e-16 * speed:
            break
        end = following
    size = bound * end / np.sqrt(end * end + smoothing * smoothing)
    return -size if slip > 0 else size


@numba.njit(cache=True, error_model="numpy", forceinline=True)
def solve_contacts(free: Any, coupling: Any, bound: Any, law: Any, impulses: Any) -> None:
    """Solve all contacts by Gauss–Seidel sweeps; `impulses` is where they start, and the solution.

    `law`, shape (3, n), are compliances, slopes and smoothing of `ScalarFriction`.
    """
    cells = free.size
    for _ in range(MOST_SWEEPS):
        change = 0.0
        for i in range(cells):
            slip = free[i]
            for j in range(cells):
                if j != i:
                    slip += coupling[i, j] * impulses[j]
            impulse = 0.0
            if bound[i] > 0:
                impulse = _impulse(slip, coupling[i, i], bound[i], law[0, i], law[1, i], law[2, i])
                change = max(change, abs(impulse - impulses[i]) / bound[i])
            impulses[i] = impulse
        if change <= SWEPT:
            return


@numba.njit(cache=True, error_model="numpy", forceinline=True)
def add_rows(parts: Any, rows: Any, total: Any) -> None:
    """Add Σ_j parts_j rows_j to `total`, in place; four rows at a time take two thirds of the time."""
    whole = parts.size - parts.size % 4
    for j in range(0, whole, 4):
        a, b, c, d = parts[j], parts[j + 1], parts[j + 2], parts[j + 3]
        for i in range(total.size):
            pair = a * rows[j, i] + b * rows[j + 1, i]
            total[i] += pair + (c * rows[j + 2, i] + d * rows[j + 3, i])
    for j in range(whole, parts.size):
        for i in range(total.size):
            total[i] += parts[j] * rows[j, i]


@numba.njit(cache=True, error_model="numpy")
def advance(
    motion: Any,
    loads: Any,
    bounds: Any,
    made: Any,
    response: Any,
    coupling: Any,
    drag: Any,
    numbers: Any,
    law: Any,
    record: Any,
) -> None:
    """Advance one lane in place; `record` is (steps, 5n), or has no rows when nothing is kept.

    `made`, shape (4n + 2, m), holds what velocities, positions and the loads at the start and at the end make of the
    velocities and slip velocities of the end, in rows that are padded with zeros; `response`, shape (n, m), what
    impulses of friction make of the velocities.
    """
    length, weight = numbers
    cells = coupling.shape[0]
    count = 2 * cells
    drags, impulses, state, free = False, np.zeros(cells), np.empty(made.shape[0]), np.empty(made.shape[1])
    for i in range(count):
        state[i], state[count + i] = motion[1, i], motion[0, i]
        drags = drags or drag[i] != 0
    slips = free[count : count + cells]
    register = flush_subnormals()
    for step in range(bounds.shape[0]):
        state[2 * count], state[2 * count + 1] = loads[step], loads[step + 1]
        for i in range(free.size):
            free[i] = 0.0
        add_rows(state, made, free)
        if drags:
            for i in range(cells):
                outer = length * drag[i] * state[i] * abs(state[i])
                inner = length * drag[cells + i] * state[cells + i] * abs(state[cells + i])
                free[i] -= outer
                free[cells + i] -= inner
                free[count + i] -= inner - outer
        solve_contacts(slips, coupling, bounds[step], law, impulses)
        add_rows(impulses, response, free)
        for i in range(count):
            before, state[i] = state[i], free[i]
            state[count + i] += length * (weight * state[i] + (1 - weight) * before)
        if record.shape[0] > 0:
            _keep(state, impulses, length, record[step])
    restore(register)
    for i in range(count):
        motion[0, i], motion[1, i] = state[count + i], state[i]


@numba.njit(cache=True, error_model="numpy", forceinline=True)
def _keep(state: Any, impulses: Any, length: Any, row: Any) -> None:
    """Write positions, velocities and friction of a step."""
    count = 2 * impulses.size
    for i in range(count):
        row[i], row[count + i] = state[count + i], state[i]
    for i in range(impulses.size):
        row[2 * count + i] = impulses[i] / length
