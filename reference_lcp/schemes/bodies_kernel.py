"""The compiled loop of equation (5) over masses, springs and contacts with one coefficient of friction each."""

from typing import Any

import numba
import numpy as np

SWEEPS = 10_000
"""Most sweeps over the contacts of a step; those that touch no body in common need two."""

SETTLED = 1e-15
"""Change of an impulse in a sweep, over the largest bound, that is round-off."""


@numba.njit(cache=True, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _product(row: Any, vector: Any) -> float:
    total = 0.0
    for k in range(vector.size):
        total += row[k] * vector[k]
    return total


@numba.njit(cache=True, nogil=True, error_model="numpy")
def advance_bodies(u: Any, q: Any, matrices: Any, loads: Any, bounds: Any, surfaces: Any, dt: float) -> Any:
    """Advance u and q, (f,), through the rows of `loads`; gives (steps, 2f + 2c) of u, q, λ_T and ġ_T.

    The `matrices` are M⁻¹ K, M⁻¹ C, Wᵀ, M⁻¹ W and Wᵀ M⁻¹ W; `loads` (steps, f) is F(t) over the masses at the start of
    each step, `bounds` (steps, c) μ N(t) Δt, and `surfaces` (steps, c) the speed of the ground at the end of each step.
    Every contact in turn takes the impulse that brings it to rest, as far as its bound lets it (projected
    Gauss-Seidel), until none changes: the solution of equation (7)'s friction part.
    """
    stiffness, damping, slip, response, coupling = matrices
    f, c = loads.shape[1], bounds.shape[1]
    record, impulse, free, before = np.empty((loads.shape[0], 2 * f + 2 * c)), np.zeros(c), np.empty(c), u
    for step in range(loads.shape[0]):
        row = record[step]
        for k in range(f):
            row[f + k] = q[k] + dt * (loads[step, k] - _product(stiffness[k], before) - _product(damping[k], q))
        for i in range(c):
            free[i] = _product(slip[i], row[f : 2 * f]) - surfaces[step, i]
        for _ in range(SWEEPS):
            change, largest = 0.0, 0.0
            for i in range(c):
                bound = bounds[step, i]
                wanted = impulse[i] - (free[i] + _product(coupling[i], impulse)) / coupling[i, i]
                wanted = min(max(wanted, -bound), bound)
                change, largest = max(change, abs(wanted - impulse[i])), max(largest, bound)
                impulse[i] = wanted
            if change <= SETTLED * largest:
                break
        for k in range(f):
            row[f + k] += _product(response[k], impulse)
            row[k] = before[k] + dt * row[f + k]
        before, q = row[:f], row[f : 2 * f]
        for i in range(c):
            rests = abs(impulse[i]) < bounds[step, i]
            row[2 * f + i] = impulse[i] / dt
            row[2 * f + c + i] = 0.0 if rests else _product(slip[i], q) - surfaces[step, i]
    return record
