"""Compiled loops over the cells of a chain of any length: its highest natural frequency, and its normal direction."""

from typing import Any

import numba
import numpy as np

BISECTIONS = 200
"""More than halve any interval of floating-point numbers to neighbours: the loop ends by itself."""


@numba.njit(cache=True, error_model="numpy")
def highest_square(outer_mass: Any, inner_mass: Any, chain_stiffness: Any, inner_stiffness: Any) -> float:
    """Largest ω² of (K − ω² M) x = 0 [1/s²], by bisection; arguments have shape (n,).

    All eigenvalues lie below s where K − s M is negative definite (Sylvester's law of inertia), which the pivots of its
    elimination, cell by cell, tell. Gershgorin's theorem gives the first upper bound.
    """
    low, high = 0.0, 0.0
    for i in range(outer_mass.size):
        next_stiffness = chain_stiffness[i + 1] if i + 1 < outer_mass.size else 0.0
        diagonal = chain_stiffness[i] + next_stiffness + inner_stiffness[i]
        high = max(high, 2 * diagonal / outer_mass[i], 2 * inner_stiffness[i] / inner_mass[i])
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        if middle <= low or middle >= high:
            break
        if _all_below(middle, outer_mass, inner_mass, chain_stiffness, inner_stiffness):
            high = middle
        else:
            low = middle
    return high


@numba.njit(cache=True, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _all_below(square: float, outer_mass: Any, inner_mass: Any, chain_stiffness: Any, inner_stiffness: Any) -> bool:
    """Whether every pivot of K − s M is negative: the inner masses go first, then the row from its base."""
    cells = outer_mass.size
    before = -np.inf
    for i in range(cells):
        inner = inner_stiffness[i] - square * inner_mass[i]
        if inner >= 0:
            return False
        next_stiffness = chain_stiffness[i + 1] if i + 1 < cells else 0.0
        outer = chain_stiffness[i] + next_stiffness + inner_stiffness[i] - square * outer_mass[i]
        outer -= inner_stiffness[i] ** 2 / inner + chain_stiffness[i] ** 2 / before
        if outer >= 0:
            return False
        before = outer
    return True


@numba.njit(cache=True, nogil=True, error_model="numpy")
def advance_normal(normal_load: Any, mass: Any, time_step: Any, start: Any, rate: Any) -> Any:
    """Advance contacts, shape (k,), through the rows of `normal_load`; gives forces, gaps and final rates."""
    force, gaps = np.zeros_like(normal_load), np.zeros_like(normal_load)
    gap, speed = start.copy(), rate.copy()
    for step in range(normal_load.shape[0]):
        for k in range(normal_load.shape[1]):
            dt, pressing = time_step[k], normal_load[step, k]
            needed = pressing - mass[k] * (speed[k] + gap[k] / dt) / dt
            if needed > 0.0:
                force[step, k] = needed
                speed[k] = -gap[k] / dt
                gap[k] = 0.0
            else:
                speed[k] -= dt * pressing / mass[k]
                gap[k] += dt * speed[k]
            gaps[step, k] = gap[k]
    return force, gaps, speed
