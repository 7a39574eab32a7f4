"""The compiled substeps of Exudyn's steps as a model, and the equations of its contacts.

`numbers`, shape (3, n), are μ λ_N, and `first` and `second` of `GeneralisedAlphaLane`. `workspace`, shape (n + 2, n),
is kept from one substep to the next: the regime of every contact, the right-hand sides of the equations in it, and the
inverse of their matrix. Arrays are handed on one by one: to unpack a tuple of them costs as much as the equations.
Loops stand where expressions of arrays would take as long again to compile.
"""

from typing import Any

import numba
import numpy as np

from engines.exudyn.step_model import BRISTLE, DISC, DISC_CORRECTIONS
from reference_lcp.schemes.linear_implicit_kernel import solve_contacts

_UNKNOWN = 9.0
"""What no regime is."""


@numba.njit(cache=True, error_model="numpy")
def zone_friction(slip: Any, bound: Any, width: Any) -> Any:
    """Give φ of a zone."""
    return bound * min(max(slip / width, -1.0), 1.0)


@numba.njit(cache=True, error_model="numpy")
def _invert(matrix: Any, workspace: Any) -> None:
    """Keep the inverse of the matrix of the equations."""
    inverse = np.linalg.inv(matrix)
    for i in range(matrix.shape[0]):
        for j in range(matrix.shape[0]):
            workspace[2 + i, j] = inverse[i, j]


@numba.njit(cache=True, error_model="numpy")
def _multiply(workspace: Any, force: Any) -> None:
    """Give the forces: the inverse times the right-hand sides."""
    cells = force.size
    for i in range(cells):
        total = 0.0
        for j in range(cells):
            total += workspace[2 + i, j] * workspace[1, j]
        force[i] = total


@numba.njit(cache=True, error_model="numpy")
def _added(free: Any, matrix: Any, i: Any, force: Any) -> Any:
    """Give an elongation or a slip velocity with the part of the forces."""
    total = free[i]
    for j in range(force.size):
        total += matrix[i, j] * force[j]
    return total


@numba.njit(cache=True, error_model="numpy")
def _regime_holds(slip: Any, mobility: Any, numbers: Any, workspace: Any, force: Any) -> Any:
    """Solve zones in the regime of the last substep, 0 in the zone and ±1 beyond, and say whether it still holds."""
    cells = slip.size
    if workspace[0, 0] == _UNKNOWN:
        return False
    for i in range(cells):
        regime = workspace[0, i]
        workspace[1, i] = regime * numbers[0, i] if regime != 0 else -slip[i]
    _multiply(workspace, force)
    for i in range(cells):
        regime, bound = workspace[0, i], numbers[0, i]
        if regime == 0:
            if abs(force[i]) > bound:
                return False
        elif bound > 0 and -regime * _added(slip, mobility, i, force) < numbers[1, i]:
            return False
    return True


@numba.njit(cache=True, error_model="numpy")
def _find_regime(slip: Any, mobility: Any, numbers: Any, workspace: Any, force: Any) -> None:
    """Solve zones by sweeps, and keep the regime that they find, where the last one does not hold."""
    bound, softness, none = numbers[0], np.empty(slip.size), np.zeros(slip.size)
    for i in range(slip.size):
        softness[i] = numbers[1, i] / bound[i]
    solve_contacts(slip, mobility, bound, (softness, none, none), force)
    matrix = np.zeros(mobility.shape)
    for i in range(slip.size):
        workspace[0, i], matrix[i, i] = -1.0 if force[i] < 0 else 1.0, 1.0
        if abs(force[i]) < bound[i]:
            workspace[0, i] = 0.0
            for j in range(slip.size):
                matrix[i, j] = mobility[i, j]
            matrix[i, i] += softness[i]
    _invert(matrix, workspace)


@numba.njit(cache=True, error_model="numpy")
def _correct_discs(
    free: Any, mobility: Any, last: Any, numbers: Any, tolerance: Any, workspace: Any, force: Any
) -> None:
    """Give λ of discs, which are in their zone, or not, by the slip velocity of the last correction.

    In its zone a force is not cut off at the bound before the next correction.
    """
    matrix = np.empty(mobility.shape)
    for _ in range(DISC_CORRECTIONS):
        for i in range(free.size):
            bound, zone = numbers[0, i], numbers[1, i]
            in_zone = last[0, i] != 0 and abs(last[0, i]) <= zone
            rate = bound / zone if in_zone else 0.0
            workspace[1, i] = -rate * free[i] if in_zone else -bound * np.sign(last[0, i])
            for j in range(free.size):
                matrix[i, j] = rate * mobility[i, j]
            matrix[i, i] += 1.0
        _invert(matrix, workspace)
        _multiply(workspace, force)
        error = 0.0
        for i in range(free.size):
            last[0, i] = _added(free, mobility, i, force)
            error = max(error, abs(zone_friction(last[0, i], numbers[0, i], numbers[1, i]) + force[i]))
        if error <= tolerance:
            return


@numba.njit(cache=True, error_model="numpy")
def _hold_bristles(
    elongation: Any,
    slip: Any,
    compliance: Any,
    mobility: Any,
    contacts: Any,
    numbers: Any,
    workspace: Any,
    force: Any,
) -> None:
    """Give λ of bristles in the states that they have at the start of the substep; a regime is 1 in stick, else 0."""
    changed = False
    for i in range(slip.size):
        stuck = 1.0 if contacts[0, i] == 0 and numbers[0, i] > 0 else 0.0
        changed = changed or stuck != workspace[0, i]
        held = numbers[1, i] * (elongation[i] - contacts[1, i]) + numbers[2, i] * slip[i]
        workspace[0, i], workspace[1, i] = stuck, -held if stuck > 0 else -contacts[0, i]
    if changed:
        matrix = np.empty(mobility.shape)
        for i in range(slip.size):
            spring, dashpot = workspace[0, i] * numbers[1, i], workspace[0, i] * numbers[2, i]
            for j in range(slip.size):
                matrix[i, j] = spring * compliance[i, j] + dashpot * mobility[i, j]
            matrix[i, i] += 1.0
        _invert(matrix, workspace)
    _multiply(workspace, force)


@numba.njit(cache=True, error_model="numpy")
def _correct_bristles(
    free_elongation: Any, free_slip: Any, compliance: Any, mobility: Any, contacts: Any, numbers: Any, force: Any
) -> None:
    """Change the states of bristles at the end of a substep; its forces stay as they were.

    A stuck one slips where its force has passed the bound, in the direction of the slip velocity, not of the force. A
    slipping one takes its foot along; where the velocity has reversed it sticks, with the force that it had.
    """
    for i in range(force.size):
        bound, stiffness, damping = numbers[0, i], numbers[1, i], numbers[2, i]
        elongation = _added(free_elongation, compliance, i, force)
        slip = _added(free_slip, mobility, i, force)
        before, direction = contacts[0, i], np.sign(slip) * bound
        if before == 0 and bound > 0:
            passed = abs(stiffness * (elongation - contacts[1, i]) + damping * slip) > bound
            contacts[0, i] = direction if passed else 0.0
        elif slip * before < 0:
            contacts[0, i] = 0.0
            contacts[1, i] = elongation - (before - damping * slip) / stiffness
        else:
            contacts[0, i], contacts[1, i] = direction, elongation


@numba.njit(cache=True, error_model="numpy")
def forces(motion: Any, contacts: Any, kind: Any, numbers: Any) -> Any:
    """Give φ of all contacts in a state."""
    cells = numbers.shape[1]
    forces = contacts[0].copy()
    for i in range(cells):
        bound, first, second = numbers[0, i], numbers[1, i], numbers[2, i]
        elongation, slip = motion[0, cells + i] - motion[0, i], motion[1, cells + i] - motion[1, i]
        if kind != BRISTLE:
            forces[i] = zone_friction(slip, bound, first)
        elif forces[i] == 0 and bound > 0:
            forces[i] = first * (elongation - contacts[1, i]) + second * slip
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
    compliance, mobility, workspace = np.empty((cells, cells)), np.empty((cells, cells)), np.empty((cells + 2, cells))
    for i in range(cells):
        workspace[0, i] = _UNKNOWN
        for j in range(cells):
            compliance[i, j], mobility[i, j] = place * coupling[i, j], speed * coupling[i, j]
    acceleration = first.copy()
    algorithmic = first.copy()
    force, elongation, slip = np.zeros(cells), np.empty(cells), np.empty(cells)
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
        if kind == DISC:
            _correct_discs(slip, mobility, contacts, numbers, tolerance, workspace, force)
        elif kind == BRISTLE:
            _hold_bristles(elongation, slip, compliance, mobility, contacts, numbers, workspace, force)
            _correct_bristles(elongation, slip, compliance, mobility, contacts, numbers, force)
        elif not _regime_holds(slip, mobility, numbers, workspace, force):
            _find_regime(slip, mobility, numbers, workspace, force)
        _add_product(response, force, acceleration)
        for i in range(2 * cells):
            q[i] += place * acceleration[i]
            v[i] += speed * acceleration[i]
            algorithmic[i] += current_part * acceleration[i]
        if record.shape[0] > 0 and index % parts == 0:
            keep(motion, forces(motion, contacts, kind, numbers), record[index // parts - 1])


@numba.njit(cache=True, error_model="numpy")
def keep(motion: Any, friction: Any, row: Any) -> None:
    """Write positions, velocities and friction of a step."""
    count = motion.shape[1]
    for i in range(count):
        row[i], row[count + i] = motion[0, i], motion[1, i]
    for i in range(friction.size):
        row[2 * count + i] = -friction[i]
