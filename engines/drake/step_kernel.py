"""The compiled steps of `GlidingLane`."""

from typing import Any

import numba
import numpy as np

from reference_lcp.schemes.linear_implicit_kernel import smooth_impulse

MOST_SWEEPS = 100
"""Gauss–Seidel sweeps at most over the contacts, which hardly touch each other."""

SWEPT = 1e-15
"""Largest change of a friction impulse in a sweep, over h μ λ_N, that ends the sweeps."""


@numba.njit(cache=True, error_model="numpy")
def advance(motion: Any, across: Any, loads: Any, matrices: Any, numbers: Any, contact: Any, record: Any) -> None:
    """Advance one lane in place; `record` is (steps, 6n), or has no rows when nothing is kept."""
    state_matrix, load_matrix, response, coupling = matrices
    h, depth = numbers
    coefficient, normal_force, mass = contact[:3]
    cells = coupling.shape[0]
    count = 2 * cells
    state, free, added = np.empty(2 * count), np.empty(state_matrix.shape[0]), np.empty(count)
    friction, normal = np.zeros(cells), np.empty(cells)
    for i in range(count):
        state[i], state[count + i] = motion[1, i], motion[0, i]
    for i in range(cells):
        normal[i] = h * normal_force[i]
    for step in range(loads.size):
        np.dot(state_matrix, state, free)
        for i in range(free.size):
            free[i] += load_matrix[i] * loads[step]
        for _ in range(MOST_SWEEPS):
            if _sweep(free[count:], coupling, across, (h, depth), contact, friction, normal) <= SWEPT:
                break
        np.dot(response, friction, added)
        for i in range(count):
            state[i] = free[i] + added[i]
            state[count + i] += h * state[i]
        for i in range(cells):
            if coefficient[i] > 0:
                across[1, i] += (normal[i] - h * normal_force[i]) / mass[i]
                across[0, i] += h * across[1, i]
        if record.shape[0] > 0:
            _keep(state, friction, normal, h, record[step])
    for i in range(count):
        motion[0, i], motion[1, i] = state[count + i], state[i]


@numba.njit(cache=True, error_model="numpy")
def _keep(state: Any, friction: Any, normal: Any, h: Any, row: Any) -> None:
    """Write positions, velocities, friction and normal force of a step."""
    cells = friction.size
    count = 2 * cells
    for i in range(count):
        row[i], row[count + i] = state[count + i], state[i]
    for i in range(cells):
        row[2 * count + i], row[2 * count + cells + i] = friction[i] / h, normal[i] / h


@numba.njit(cache=True, error_model="numpy")
def _sweep(free: Any, coupling: Any, across: Any, numbers: Any, contact: Any, friction: Any, normal: Any) -> Any:
    """Solve every contact once, with the friction of the others as it is; gives the largest change over h μ λ_N."""
    h, depth = numbers
    coefficient, normal_force, mass, softness, smoothing = contact
    cells, largest = free.size, 0.0
    for i in range(cells):
        if coefficient[i] == 0:
            continue
        if across[0, i] >= 0:  # Drake finds no contact at the start of the step
            friction[i], normal[i] = 0.0, 0.0
            continue
        slip = free[i]
        for j in range(cells):
            if j != i:
                slip += coupling[i, j] * friction[j]
        before = friction[i]
        rate = across[1, i] - h * normal_force[i] / mass[i]
        cell = (slip, coupling[i, i], rate, across[0, i], normal_force[i] / depth, mass[i], coefficient[i], h)
        if smoothing[i] > 0:
            friction[i], normal[i] = _similar(cell, smoothing[i], normal[i])
        else:
            friction[i], normal[i] = _sap(cell, softness[i])
        largest = max(largest, abs(friction[i] - before) / (h * coefficient[i] * normal_force[i]))
    return largest


@numba.njit(cache=True, error_model="numpy")
def _sap(cell: Any, softness: Any) -> Any:
    """Give friction and normal impulse of kSap without a relaxation time: stick if the cone allows it, else slide."""
    slip, coupling, rate, place, stiffness, mass, coefficient, h = cell
    compliance = 1 / (h * h * stiffness)
    lacking = -place / h - rate
    friction, normal = -slip / (softness + coupling), lacking / (compliance + 1 / mass)
    if abs(friction) > coefficient * normal:
        share = coefficient * coefficient * (softness + coupling)
        normal = max((lacking + coefficient * abs(slip)) / (compliance + 1 / mass + share), 0.0)
        friction = -np.sign(slip) * coefficient * normal
    return friction, normal


@numba.njit(cache=True, error_model="numpy")
def _similar(cell: Any, smoothing: Any, start: Any) -> Any:
    """Give friction and normal impulse of kSimilar: Newton's method on the normal one, kept in its bracket."""
    slip, coupling, rate, place, stiffness, mass, coefficient, h = cell
    low, high = 0.0, h * stiffness * (abs(place) + h * (abs(rate) + coefficient * abs(slip)))
    normal, friction = min(start, high), 0.0
    for _ in range(100):
        friction = smooth_impulse(slip, coupling, coefficient * normal, smoothing)
        speed = abs(slip + coupling * friction)
        root = np.sqrt(speed * speed + smoothing * smoothing)
        approach = rate + normal / mass - coefficient * (root - smoothing)
        force = -stiffness * (place + h * approach)
        excess, slope = normal - h * max(force, 0.0), 1.0
        if excess > 0:
            high = normal
        else:
            low = normal
        if force > 0:
            steep = 1 + coupling * coefficient * normal * smoothing * smoothing / root**3
            slope += h * h * stiffness * (1 / mass + coupling * (coefficient * speed / root) ** 2 / steep)
        following = normal - excess / slope
        if not low < following < high:
            following = (low + high) / 2
        if abs(following - normal) <= 1e-16 * high:
            break
        normal = following
    return friction, normal
