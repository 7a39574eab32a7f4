"""The compiled substeps of `GeneralisedAlphaLane`."""

from typing import Any

import numba
import numpy as np

from engines.exudyn.friction_kernel import force_of, softness_of, solve_friction


@numba.njit(cache=True, error_model="numpy")
def _first_acceleration(motion: Any, contacts: Any, load: Any, matrices: Any, law: Any) -> Any:
    """Give the accelerations of the first state of a run."""
    inverse_mass, stiffness, damping = matrices
    q, v, cells = motion[0], motion[1], law[1].size
    rest = -(stiffness @ q) - damping @ v
    rest[0] += load
    force = force_of(q[cells:] - q[:cells], v[cells:] - v[:cells], contacts, law)
    rest[:cells] += force
    rest[cells:] -= force
    return inverse_mass @ rest


@numba.njit(cache=True, error_model="numpy", inline="always")
def _add_product(columns: Any, factors: Any, total: Any) -> None:
    """Add Σ_j factors_j columns_j to `total`, in place."""
    for j in range(factors.size):
        factor = factors[j]
        for i in range(total.size):
            total[i] += factor * columns[j, i]


@numba.njit(cache=True, error_model="numpy")
def advance(motion: Any, contacts: Any, loads: Any, matrices: Any, rule: Any, law: Any, record: Any) -> None:
    """Advance motion and contacts in place; `record` is (steps, 5n), or has no rows when nothing is kept."""
    place_columns, speed_columns, load_column, response, coupling = matrices[1:]
    h, parts, algorithmic_part, previous_part, current_part, beta, gamma = rule
    q, v = motion[0], motion[1]
    cells = coupling.shape[0]
    place, speed = current_part * h * h * beta, current_part * h * gamma
    compliance, mobility = place * coupling, speed * coupling
    acceleration = _first_acceleration(motion, contacts, loads[0], matrices[0], law)
    algorithmic = acceleration.copy()
    force, elongation, slip = np.zeros(cells), np.empty(cells), np.empty(cells)
    softness = softness_of(law)
    for index in range(1, loads.size):
        for i in range(2 * cells):
            base = algorithmic_part * algorithmic[i] + previous_part * acceleration[i]
            q[i] += h * v[i] + h * h * ((0.5 - beta) * algorithmic[i] + beta * base)
            v[i] += h * ((1 - gamma) * algorithmic[i] + gamma * base)
            algorithmic[i] = base
            acceleration[i] = load_column[i] * loads[index]
        _add_product(place_columns, q, acceleration)
        _add_product(speed_columns, v, acceleration)
        for i in range(cells):  # in the order of the step's end, so that a foot without friction is exactly there
            outer, inner = acceleration[i], acceleration[cells + i]
            elongation[i] = (q[cells + i] + place * inner) - (q[i] + place * outer)
            slip[i] = (v[cells + i] + speed * inner) - (v[i] + speed * outer)
        force = solve_friction(elongation, slip, compliance, mobility, contacts, law, softness, force)
        _add_product(response, force, acceleration)
        for i in range(2 * cells):
            q[i] += place * acceleration[i]
            v[i] += speed * acceleration[i]
            algorithmic[i] += current_part * acceleration[i]
        if record.shape[0] > 0 and index % parts == 0:
            row = record[index // parts - 1]
            row[: 2 * cells], row[2 * cells : 4 * cells] = q, v
            row[4 * cells :] = -force_of(q[cells:] - q[:cells], v[cells:] - v[:cells], contacts, law)
