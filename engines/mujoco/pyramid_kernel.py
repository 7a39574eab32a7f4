"""The compiled steps of `PyramidLane`, and the convex problem of a contact."""

from typing import Any

import numba
import numpy as np

MOST_CORRECTIONS = 20
"""Sets of pressing edges that Newton's iteration tries; it needs two or three, and may cycle."""


@numba.njit(cache=True, error_model="numpy")
def _solved(coupling: Any, aim: Any, pressing: Any) -> Any:
    """Give p of the edges that press, (E A Eᵀ + R) p = −(E y_free + o), and (E A Eᵀ) p + E y_free + o of the others."""
    matrix, right = coupling.copy(), -aim
    for edge in range(aim.size):
        if not pressing[edge]:
            matrix[:, edge] = 0.0
            matrix[edge, edge] = -1.0
    return np.linalg.solve(matrix, right)


@numba.njit(cache=True, error_model="numpy")
def edge_impulses(free: Any, inverse_mass: Any, edges: Any, softness: Any, offset: Any) -> Any:
    """Give p >= 0 of every edge with E y + o + R p >= 0, one or the other zero, and y = y_free + A Eᵀ p.

    Newton's iteration over the sets of edges that press; where it cycles, all sets are tried.
    """
    count = edges.shape[0]
    coupling = (edges * inverse_mass) @ edges.T + softness * np.eye(count)
    aim = edges @ free + offset
    pressing = np.ones(count, np.bool_)
    for _ in range(MOST_CORRECTIONS):
        solution = _solved(coupling, aim, pressing)
        following = np.where(solution < 0, ~pressing, pressing)
        if np.all(following == pressing):
            return np.where(pressing, solution, 0.0)
        pressing = following
    best, least = np.zeros(count), np.inf
    for number in range(2**count):
        for edge in range(count):
            pressing[edge] = (number >> edge) & 1
        solution = _solved(coupling, aim, pressing)
        if np.max(-solution) < least:
            best, least = np.where(pressing, np.maximum(solution, 0.0), 0.0), np.max(-solution)
    return best


@numba.njit(cache=True, error_model="numpy")
def impedance(depth: Any, least: Any, largest: Any, width: Any) -> Any:
    """Give d at a depth [m]: `solimp` with its midpoint 0.5 and its power 2, MuJoCo's own."""
    part = min(1.0, depth / width)
    rise = 2 * part**2 if part <= 0.5 else 1 - 2 * (1 - part) ** 2
    return least + (largest - least) * rise


@numba.njit(cache=True, error_model="numpy")
def _contact_impulses(free: Any, press: Any, depth: Any, contact: Any, edges: Any, constraint: Any) -> Any:
    """Give the impulses of the edges of one contact.

    Parameters
    ----------
    free
        h (a_0 + b w) in the three directions: where no edge presses it stays so.
    press
        What presses a contact that is held at its depth, times h.
    depth
        Of the sphere at the start of the step [m].
    contact
        Inverse masses in the three directions, and what the softness of edges is in proportion to.
    constraint
        h k, and d_0, d_max and δ of `solimp`; k is zero where the depth is held.
    """
    stiffness, least, largest, width = constraint
    if depth <= 0:
        return np.zeros(edges.shape[0])
    part = impedance(depth, least, largest, width)
    softness = contact[3] * (1 - part) / part
    # what each edge aims at: to get out of the plate, or to press with its share
    offset = -stiffness * part * depth if stiffness > 0 else -softness * press / edges.shape[0]
    return edge_impulses(free, contact[:3], edges, softness, offset)


@numba.njit(cache=True, error_model="numpy")
def advance(
    motion: Any, aside: Any, loads: Any, presses: Any, matrices: Any, numbers: Any, contacts: Any, record: Any
) -> None:
    """Advance one lane in place; see `PyramidLane`.

    Parameters
    ----------
    motion
        Positions and velocities along the row, shape (2, 2n).
    aside
        Of every cell: velocity across the row in the plane of its contacts, height, its rate; shape (n, 3).
    loads, presses
        Force on cell 1, shape (steps,), and what presses contacts, shape (steps, n).
    matrices, numbers, contacts
        Of the linear step; h, b and the depths at no gap; inverse masses and softness, normal and tangent along the
        row, edges, and numbers of the constraint.
    record
        Gets positions, velocities, friction, normal force, gap of each step, shape (steps, 7n); without rows, nothing.
    """
    state_matrix, load, response = matrices
    length, rate, touch = numbers
    contact, normal, tangent, edges, constraint = contacts
    cells, size = contact.shape[0], motion.shape[1]
    state = np.concatenate((motion[1], motion[0]))
    free, seen, held = np.empty(3), np.empty(size + cells), constraint[0] == 0
    for step in range(loads.size):
        seen[:] = state_matrix @ state + load * loads[step]
        for i in range(cells):
            gap = normal[2] * aside[i, 1] + normal[0] * (state[size + cells + i] - state[size + i])
            impulse = np.zeros(3) if held else -length * presses[step, i] * normal
            free[0], free[1], free[2] = seen[size + i], length * rate * aside[i, 0], length * rate * aside[i, 2]
            free += contact[i, :3] * impulse
            parts = _contact_impulses(free, length * presses[step, i], touch[i] - gap, contact[i], edges[i], constraint)
            pressed = parts @ edges[i]
            impulse += pressed
            if record.shape[0] > 0:
                record[step, 2 * size + i] = pressed @ tangent / length
                record[step, 2 * size + cells + i] = np.sum(parts) / length
            aside[i, 0] += contact[i, 1] * impulse[1]
            aside[i, 2] += contact[i, 2] * impulse[2]
            aside[i, 1] += length * aside[i, 2]
            seen[:size] += response[:, i] * impulse[0]
        state[:size] = seen[:size]
        state[size:] += length * state[:size]
        if record.shape[0] > 0:
            record[step, :size], record[step, size : 2 * size] = state[size:], state[:size]
            for i in range(cells):
                gap = normal[2] * aside[i, 1] + normal[0] * (state[size + cells + i] - state[size + i])
                record[step, 2 * size + 2 * cells + i] = gap
    motion[0], motion[1] = state[size:], state[:size]
