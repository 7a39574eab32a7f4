"""The kernel of equation (7) for chains with inclined contacts: Lemke's method, contact by contact.

A contact touches the two masses of its own cell alone, and M is diagonal; so the blocks G_NN, G_NT, G_TN and G_TT of
equation (7) are diagonal too. Its LCP splits into one of three unknowns for each contact, (Λ_N Δt, Λ_TR Δt, ġ_T⁻ Δt),
with a matrix that no step changes.
"""

from typing import Any

import numba
import numpy as np

from reference_lcp.lcp.pivoting import SOLVED, solve_scaled_lcp

UNKNOWNS = 3
"""Of the LCP of a contact."""

FIELDS = 8
"""Numbers of a contact in a row of the record: u, v, y, their velocities, λ_T and λ_N."""

PIVOT_LIMIT = 50 * UNKNOWNS + 100
"""As in `reference_lcp.lcp.lemke.lemke`."""

NO_COVERING = np.zeros(0)
"""Lemke's own covering vector, of ones."""


@numba.njit(cache=True, nogil=True, error_model="numpy")
def advance_inclined(
    x: Any, springs: Any, masses: Any, matrices: Any, scales: Any, angle: Any, time_step: float, loads: Any,
    preloads: Any, paths: int, record: Any,
) -> Any:  # fmt: skip
    """Advance one lane in place, and write each step's end; gives how many steps were solved, and Lemke's last status.

    Parameters
    ----------
    x
        u, v, y and their velocities, shape (6, n).
    springs
        Chain stiffness, chain damping, inner stiffness, inner damping, shape (4, n).
    masses
        m_o and m_i, shape (2, n).
    matrices
        Of the LCP of each contact, shape (n, 3, 3).
    scales
        Row and column factors of each, see `power_of_two_scaling`, shape (n, 2, 3).
    angle
        μ of each contact, sin α and cos α, shape (3, n).
    time_step
        Δt [s].
    loads, preloads
        On the first outer mass, and N along the normals, at the start of each step [N], shapes (steps,) and (steps, n).
    paths
        Of Lemke's method that a step may try.
    record
        Shape (steps, 8, n), see `FIELDS`.
    """
    cells = x.shape[1]
    basic, warm = np.zeros((cells, UNKNOWNS), dtype=np.bool_), False
    for step in range(loads.size):
        pull = _pull(x, springs, 0, 0.0, 0.0) - loads[step]
        for i in range(cells):
            ahead = 0.0 if i + 1 == cells else _pull(x, springs, i + 1, x[0, i], x[3, i])
            free = _free_velocities(x, springs, masses, i, ahead - pull, angle, preloads[step, i], time_step)
            pull = ahead
            q = _vector(x, free, angle, i, time_step)
            start = basic[i] if warm else basic[i, :0]
            z, _, _, code, _, basis = solve_scaled_lcp(
                matrices[i], q, scales[i, 0], scales[i, 1], NO_COVERING, PIVOT_LIMIT, start, paths
            )
            if code != SOLVED:
                return step, code
            basic[i] = basis
            _end_step(x, free, masses, angle, i, z, time_step, record[step])
        warm = True
    return loads.size, SOLVED


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _pull(x: Any, springs: Any, cell: int, before: float, rate_before: float) -> float:
    """Force of the chain element at the left of a cell, whose other end is at `before`."""
    return springs[0, cell] * (x[0, cell] - before) + springs[1, cell] * (x[3, cell] - rate_before)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _free_velocities(
    x: Any, springs: Any, masses: Any, i: int, along: float, angle: Any, normal: float, time_step: float
) -> Any:
    """Velocities of u, v and y at the end of the step if no contact acted; `along` is the chain's force on u."""
    inner = springs[2, i] * (x[1, i] - x[0, i]) + springs[3, i] * (x[4, i] - x[3, i])
    sine, cosine = angle[1, i], angle[2, i]
    outer = x[3, i] + time_step * (along + inner - sine * normal) / masses[0, i]
    row = x[4, i] + time_step * (sine * normal - inner) / masses[1, i]
    return outer, row, x[5, i] - time_step * cosine * normal / masses[1, i]


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _vector(x: Any, free: Any, angle: Any, i: int, time_step: float) -> Any:
    """The vector (C_N, C_T Δt, 0) of the LCP of a contact."""
    sine, cosine = angle[1, i], angle[2, i]
    gap = cosine * x[2, i] - sine * (x[1, i] - x[0, i])
    parting = cosine * free[2] - sine * (free[1] - free[0])
    slip = cosine * (free[1] - free[0]) + sine * free[2]
    return np.array([gap + time_step * parting, time_step * slip, 0.0])


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _end_step(x: Any, free: Any, masses: Any, angle: Any, i: int, z: Any, time_step: float, row: Any) -> None:
    """Let the contact act, move the masses, and write the cell's numbers into its row."""
    mu, sine, cosine = angle[0, i], angle[1, i], angle[2, i]
    normal = z[0] / time_step
    tangential = z[1] / time_step - mu * normal
    along, across = cosine * tangential - sine * normal, sine * tangential + cosine * normal
    velocities = (free[0] - along / masses[0, i], free[1] + along / masses[1, i], free[2] + across / masses[1, i])
    for k in range(UNKNOWNS):
        x[UNKNOWNS + k, i] = velocities[k]
        x[k, i] += time_step * velocities[k]
    row[: 2 * UNKNOWNS, i] = x[:, i]
    row[2 * UNKNOWNS, i], row[2 * UNKNOWNS + 1, i] = tangential / time_step, normal / time_step
