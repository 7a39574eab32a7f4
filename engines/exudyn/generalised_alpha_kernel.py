"""The compiled substeps of `GeneralisedAlphaLane`."""

from typing import Any

import numba
import numpy as np

from engines.exudyn.friction_kernel import force_of, new_workspace, regime_holds, solve_friction
from engines.exudyn.friction_models import ZONE


@numba.njit(cache=True, error_model="numpy")
def forces(motion: Any, contacts: Any, kind: Any, numbers: Any) -> Any:
    """Give φ of all contacts in a state."""
    cells = numbers.shape[1]
    forces = np.empty(cells)
    for i in range(cells):
        elongation, slip = motion[0, cells + i] - motion[0, i], motion[1, cells + i] - motion[1, i]
        forces[i] = force_of(elongation, slip, contacts, kind, numbers, i)
    return forces


@numba.njit(cache=True, error_model="numpy")
def _add_product(columns: Any, factors: Any, total: Any) -> None:
    """Add Σ_j factors_j columns_j to `total`, in place; two columns at a time take three quarters of the time."""
    for j in range(0, factors.size - 1, 2):
        first, second = factors[j], factors[j + 1]
        for i in range(total.size):
            total[i] += first * columns[j, i] + second * columns[j + 1, i]
    if factors.size % 2 == 1:
        last = factors.size - 1
        for i in range(total.size):
            total[i] += factors[last] * columns[last, i]


@numba.njit(cache=True, error_model="numpy")
def advance(
    motion: Any,
    contacts: Any,
    first: Any,
    loads: Any,
    matrices: Any,
    rule: Any,
    kind: Any,
    numbers: Any,
    tolerance: Any,
    record: Any,
) -> None:
    """Advance motion and contacts in place, from the accelerations `first`.

    `record` is (steps, 5n), or has no rows when nothing is kept.
    """
    place_columns, speed_columns, load_column, response, coupling = matrices
    h, parts, algorithmic_part, previous_part, current_part, beta, gamma = rule
    q, v = motion[0], motion[1]
    cells = coupling.shape[0]
    place, speed = current_part * h * h * beta, current_part * h * gamma
    compliance, mobility = place * coupling, speed * coupling
    acceleration = first.copy()
    algorithmic = first.copy()
    force, elongation, slip = np.zeros(cells), np.empty(cells), np.empty(cells)
    workspace = new_workspace(cells)
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
        # What nearly every substep does is compiled into the loop: it takes two thirds of the time.
        if kind != ZONE or not regime_holds(slip, mobility, numbers, workspace, force):
            solve_friction(elongation, slip, compliance, mobility, contacts, kind, numbers, tolerance, workspace, force)
        _add_product(response, force, acceleration)
        for i in range(2 * cells):
            q[i] += place * acceleration[i]
            v[i] += speed * acceleration[i]
            algorithmic[i] += current_part * acceleration[i]
        if record.shape[0] > 0 and index % parts == 0:
            row = record[index // parts - 1]
            row[: 2 * cells], row[2 * cells : 4 * cells] = q, v
            row[4 * cells :] = -forces(motion, contacts, kind, numbers)
