"""The compiled steps of `LinearImplicitLane`, and the equations of its contacts."""

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


@numba.njit(cache=True, error_model="numpy")
def solve_contacts(free: Any, coupling: Any, bound: Any, law: Any, impulses: Any) -> None:
    """Solve all contacts by Gauss–Seidel sweeps; `impulses` is where they start, and the solution."""
    compliance, slope, smoothing = law
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
                impulse = _impulse(slip, coupling[i, i], bound[i], compliance[i], slope[i], smoothing[i])
                change = max(change, abs(impulse - impulses[i]) / bound[i])
            impulses[i] = impulse
        if change <= SWEPT:
            return


@numba.njit(cache=True, error_model="numpy")
def advance(motion: Any, loads: Any, bounds: Any, matrices: Any, numbers: Any, law: Any, record: Any) -> None:
    """Advance one lane in place; `record` is (steps, 5n), or has no rows when nothing is kept.

    Loops stand where expressions of arrays would take twice as long to compile.
    """
    state_matrix, load_matrix, response, coupling, drag = matrices
    length, weight = numbers
    cells = coupling.shape[0]
    count = 2 * cells
    drags, impulses, state, free = False, np.zeros(cells), np.empty(2 * count), np.empty(count + cells)
    moved, added = np.empty(state_matrix.shape[0]), np.empty(response.shape[0])
    for i in range(count):
        state[i], state[count + i] = motion[1, i], motion[0, i]
        drags = drags or drag[i] != 0
    register = flush_subnormals()
    for step in range(bounds.shape[0]):
        np.dot(state_matrix, state, moved)
        for i in range(count + cells):
            free[i] = moved[i] + load_matrix[i, 0] * loads[step] + load_matrix[i, 1] * loads[step + 1]
        if drags:
            for i in range(cells):
                outer = length * drag[i] * state[i] * abs(state[i])
                inner = length * drag[cells + i] * state[cells + i] * abs(state[cells + i])
                free[i] -= outer
                free[cells + i] -= inner
                free[count + i] -= inner - outer
        solve_contacts(free[count:], coupling, bounds[step], law, impulses)
        np.dot(response, impulses, added)
        for i in range(count):
            before, state[i] = state[i], free[i] + added[i]
            state[count + i] += length * (weight * state[i] + (1 - weight) * before)
        if record.shape[0] > 0:
            _keep(state, impulses, length, record[step])
    restore(register)
    for i in range(count):
        motion[0, i], motion[1, i] = state[count + i], state[i]


@numba.njit(cache=True, error_model="numpy")
def _keep(state: Any, impulses: Any, length: Any, row: Any) -> None:
    """Write positions, velocities and friction of a step."""
    count = 2 * impulses.size
    for i in range(count):
        row[i], row[count + i] = state[count + i], state[i]
    for i in range(impulses.size):
        row[2 * count + i] = impulses[i] / length
