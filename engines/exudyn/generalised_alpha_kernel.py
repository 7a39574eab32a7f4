"""The compiled substeps of `GeneralisedAlphaLane`."""

from typing import Any

import numba
import numpy as np

from engines.exudyn.friction_kernel import force_of, solve_friction


@numba.njit(cache=True, error_model="numpy")
def _first_acceleration(motion: Any, contacts: Any, load: Any, matrices: Any, law: Any) -> Any:
    """Give the accelerations of the first state of a run."""
    inverse_mass, _, stiffness, damping, _, coupling = matrices
    q, v, cells = motion[0], motion[1], coupling.shape[0]
    rest = -(stiffness @ q) - damping @ v
    rest[0] += load
    force = force_of(q[cells:] - q[:cells], v[cells:] - v[:cells], contacts, law)
    rest[:cells] += force
    rest[cells:] -= force
    return inverse_mass @ rest


@numba.njit(cache=True, error_model="numpy")
def advance(motion: Any, contacts: Any, loads: Any, matrices: Any, rule: Any, law: Any, record: Any) -> None:
    """Advance motion and contacts in place; `record` is (steps, 5n), or has no rows when nothing is kept."""
    _, inverse, stiffness, damping, response, coupling = matrices
    h, parts, algorithmic_part, previous_part, current_part, beta, gamma = rule
    q, v = motion[0], motion[1]
    cells = coupling.shape[0]
    place, speed = current_part * h * h * beta, current_part * h * gamma
    acceleration = _first_acceleration(motion, contacts, loads[0], matrices, law)
    algorithmic = acceleration.copy()
    impulses = np.zeros(cells)
    for index in range(1, loads.size):
        base = algorithmic_part * algorithmic + previous_part * acceleration
        q += h * v + h * h * ((0.5 - beta) * algorithmic + beta * base)
        v += h * ((1 - gamma) * algorithmic + gamma * base)
        rest = -(stiffness @ q) - damping @ v
        rest[0] += loads[index]
        free = inverse @ rest
        free_place, free_speed = q + place * free, v + speed * free
        elongation, slip = free_place[cells:] - free_place[:cells], free_speed[cells:] - free_speed[:cells]
        force = solve_friction(elongation, slip, place * coupling, speed * coupling, contacts, law, impulses)
        acceleration = free - response @ force
        q += place * acceleration
        v += speed * acceleration
        algorithmic = base + current_part * acceleration
        if record.shape[0] > 0 and index % parts == 0:
            row = record[index // parts - 1]
            row[: 2 * cells], row[2 * cells : 4 * cells] = q, v
            row[4 * cells :] = -force_of(q[cells:] - q[:cells], v[cells:] - v[:cells], contacts, law)
