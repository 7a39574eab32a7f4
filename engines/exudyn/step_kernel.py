"""The compiled substeps of Exudyn's steps as a model, and the equations of its contacts.

`numbers`, shape (3, n), are μ λ_N, and `first` and `second` of `GeneralisedAlphaLane`.

While no contact changes its regime, the end of a substep is linear in `state`, shape (4n + 2,): positions and
velocities without the new accelerations, the load, and 1. `terms`, shape (4, n), are the regime: with elongations x and
slip velocities w of the end, terms_0 λ + terms_1 x + terms_2 w + terms_3 = 0. `accelerations`, shape (5n + 2, m), holds
in each row what a part of the state, or a force λ, makes of accelerations, and `shapes`, shape (2, n, 5n + 2), of x and
w; `response`, shape (4n + 2, m), what a part of the state makes together with the forces that it makes. Rows are padded
to m columns. Loops stand where expressions of arrays would take as long again to compile.
"""

from typing import Any

import numba
import numpy as np

from multibody_xval.engines.exudyn.step_model import BRISTLE, DISC_CORRECTIONS, ZONE
from reference_lcp.schemes.linear_implicit_kernel import add_rows, solve_contacts


@numba.njit(cache=True, error_model="numpy", forceinline=True)
def zone_friction(slip: Any, bound: Any, width: Any) -> Any:
    """Give φ of a zone."""
    return bound * min(max(slip / width, -1.0), 1.0)


@numba.njit(cache=True, error_model="numpy")
def _respond(terms: Any, accelerations: Any, shapes: Any, response: Any) -> None:
    """Make the response anew, after a change of `terms`.

    By elimination without pivoting: all principal minors are positive, and LAPACK takes seconds to be compiled for.
    """
    size, cells = response.shape[0], terms.shape[1]
    rows = np.empty((cells, size + cells))
    for i in range(cells):
        for j in range(size + cells):
            rows[i, j] = terms[1, i] * shapes[0, i, j] + terms[2, i] * shapes[1, i, j]
        rows[i, size + i] += terms[0, i]
        rows[i, size - 1] += terms[3, i]
    for k in range(cells):
        for i in range(cells):
            factor = rows[i, size + k] / rows[k, size + k]
            if i != k and factor != 0:
                for j in range(size + cells):
                    rows[i, j] -= factor * rows[k, j]
    for i in range(size):
        for j in range(response.shape[1]):
            response[i, j] = accelerations[i, j]
        for k in range(cells):
            force = rows[k, i] / rows[k, size + k]
            for j in range(response.shape[1]):
                response[i, j] -= force * accelerations[size + k, j]


@numba.njit(cache=True, error_model="numpy", forceinline=True)
def _end(state: Any, response: Any, place: Any, speed: Any, acceleration: Any, ends: Any) -> None:
    """Give the accelerations of the end of a substep, and elongations and slip velocities there.

    Elongations are added up as positions are, so that a foot without friction is exactly there.
    """
    cells = ends.shape[1]
    for i in range(acceleration.size):
        acceleration[i] = 0.0
    add_rows(state, response, acceleration)
    for i in range(cells):
        outer, inner, v = acceleration[i], acceleration[cells + i], 2 * cells + i
        ends[0, i] = (state[cells + i] + place * inner) - (state[i] + place * outer)
        ends[1, i] = (state[v + cells] + speed * inner) - (state[v] + speed * outer)


@numba.njit(cache=True, error_model="numpy", forceinline=True)
def _zones_hold(ends: Any, numbers: Any, terms: Any) -> Any:
    """Say whether zones are in their regime at the end of a substep: inside, or beyond it on one side."""
    for i in range(terms.shape[1]):
        bound, width, slip = numbers[0, i], numbers[1, i], ends[1, i]
        if terms[2, i] > 0:
            if abs(slip) > width:
                return False
        elif terms[3, i] * slip < bound * width:
            return False
    return True


@numba.njit(cache=True, error_model="numpy")
def _find_zones(state: Any, slips: Any, numbers: Any, last: Any, terms: Any) -> None:
    """Find the regime of zones by sweeps, from their friction at the `last` slip velocities that were tried."""
    cells, bound = terms.shape[1], numbers[0]
    free, force, law = np.zeros(cells), np.empty(cells), np.zeros((3, cells))
    for i in range(cells):
        for j in range(state.size):
            free[i] += slips[i, j] * state[j]
        law[0, i] = numbers[1, i] / bound[i]
        force[i] = -zone_friction(last[i], bound[i], numbers[1, i])
    solve_contacts(free, slips[:, state.size :], bound, law, force)
    for i in range(cells):
        inside = abs(force[i]) < bound[i]
        terms[0, i], terms[2, i] = (law[0, i], 1.0) if inside else (1.0, 0.0)
        terms[3, i] = 0.0 if inside else -force[i]


@numba.njit(cache=True, error_model="numpy", forceinline=True)
def _discs_change(contacts: Any, numbers: Any, terms: Any) -> Any:
    """Let discs be in their zone, or not, by the slip velocity of the last correction, and say whether any has changed.

    In its zone a force is not cut off at the bound before the next correction.
    """
    changed = False
    for i in range(terms.shape[1]):
        bound, width, last = numbers[0, i], numbers[1, i], contacts[0, i]
        inside = last != 0 and abs(last) <= width
        rate, constant = (bound / width, 0.0) if inside else (0.0, bound * np.sign(last))
        changed = changed or rate != terms[2, i] or constant != terms[3, i]
        terms[2, i], terms[3, i] = rate, constant
    return changed


@numba.njit(cache=True, error_model="numpy", forceinline=True)
def _correct_discs(ends: Any, contacts: Any, numbers: Any, terms: Any) -> Any:
    """Let discs take the slip velocities of the end, and give the largest difference of friction there from λ."""
    error = 0.0
    for i in range(terms.shape[1]):
        slip = contacts[0, i] = ends[1, i]
        force = terms[2, i] * slip + terms[3, i]
        error = max(error, abs(zone_friction(slip, numbers[0, i], numbers[1, i]) - force))
    return error


@numba.njit(cache=True, error_model="numpy", forceinline=True)
def _bristles_change(contacts: Any, numbers: Any, terms: Any) -> Any:
    """Let bristles be in the states that they have at the start of the substep, and say whether any has changed."""
    changed = False
    for i in range(contacts.shape[1]):
        spring, dashpot, constant = 0.0, 0.0, contacts[0, i]
        if constant == 0 and numbers[0, i] > 0:
            spring, dashpot, constant = numbers[1, i], numbers[2, i], -numbers[1, i] * contacts[1, i]
        changed = changed or spring != terms[1, i] or constant != terms[3, i]
        terms[1, i], terms[2, i], terms[3, i] = spring, dashpot, constant
    return changed


@numba.njit(cache=True, error_model="numpy", forceinline=True)
def _correct_bristles(ends: Any, contacts: Any, numbers: Any) -> None:
    """Change the states of bristles at the end of a substep; its forces stay as they were.

    A stuck one slips where its force has passed the bound, in the direction of the slip velocity, not of the force. A
    slipping one takes its foot along; where the velocity has reversed it sticks, with the force that it had.
    """
    for i in range(contacts.shape[1]):
        bound, stiffness, damping = numbers[0, i], numbers[1, i], numbers[2, i]
        elongation, slip = ends[0, i], ends[1, i]
        before, direction = contacts[0, i], np.sign(slip) * bound
        if before == 0 and bound > 0:
            passed = abs(stiffness * (elongation - contacts[1, i]) + damping * slip) > bound
            contacts[0, i] = direction if passed else 0.0
        elif slip * before < 0:
            contacts[0, i] = 0.0
            contacts[1, i] = elongation - (before - damping * slip) / stiffness
        else:
            contacts[0, i], contacts[1, i] = direction, elongation


@numba.njit(cache=True, error_model="numpy", forceinline=True)
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


@numba.njit(cache=True, error_model="numpy", forceinline=True)
def _predict(motion: Any, acceleration: Any, algorithmic: Any, rule: Any) -> None:
    """Take the part of a substep that its own accelerations have not."""
    h, _, algorithmic_part, previous_part, _, beta, gamma = rule
    for i in range(algorithmic.size):
        before, after = algorithmic[i], algorithmic_part * algorithmic[i] + previous_part * acceleration[i]
        motion[0, i] += h * motion[1, i] + h * h * ((0.5 - beta) * before + beta * after)
        motion[1, i] += h * ((1 - gamma) * before + gamma * after)
        algorithmic[i] = after


@numba.njit(cache=True, error_model="numpy")
def advance(
    state: Any,
    motion: Any,
    contacts: Any,
    acceleration: Any,
    loads: Any,
    accelerations: Any,
    shapes: Any,
    rule: Any,
    kind: Any,
    numbers: Any,
    tolerance: Any,
    record: Any,
) -> None:
    """Advance the state, of which `motion` is a view, contacts and accelerations in place.

    `record` is (steps, 5n), or has no rows when nothing is kept. What is called in the loop is handed few arrays: to
    hand on ten of them takes as long as a substep.
    """
    cells, part = numbers.shape[1], rule[4]
    place, speed = part * rule[0] * rule[0] * rule[5], part * rule[0] * rule[6]
    terms, ends, response = np.zeros((4, cells)), np.empty((2, cells)), np.empty((state.size, acceleration.size))
    algorithmic = acceleration[: 2 * cells].copy()
    terms[0] = 1.0
    _respond(terms, accelerations, shapes, response)
    for index in range(1, loads.size):
        _predict(motion, acceleration, algorithmic, rule)
        state[4 * cells] = loads[index]
        if kind == ZONE:
            _end(state, response, place, speed, acceleration, ends)
            if not _zones_hold(ends, numbers, terms):
                _find_zones(state, shapes[1], numbers, ends[1], terms)
                _respond(terms, accelerations, shapes, response)
                _end(state, response, place, speed, acceleration, ends)
        elif kind == BRISTLE:
            if _bristles_change(contacts, numbers, terms):
                _respond(terms, accelerations, shapes, response)
            _end(state, response, place, speed, acceleration, ends)
            _correct_bristles(ends, contacts, numbers)
        else:
            for _ in range(DISC_CORRECTIONS):
                if _discs_change(contacts, numbers, terms):
                    _respond(terms, accelerations, shapes, response)
                _end(state, response, place, speed, acceleration, ends)
                if _correct_discs(ends, contacts, numbers, terms) <= tolerance:
                    break
        for i in range(2 * cells):
            motion[0, i] += place * acceleration[i]
            motion[1, i] += speed * acceleration[i]
            algorithmic[i] += part * acceleration[i]
        if record.shape[0] > 0 and index % rule[1] == 0:
            keep(motion, forces(motion, contacts, kind, numbers), record[index // rule[1] - 1])


@numba.njit(cache=True, error_model="numpy", forceinline=True)
def keep(motion: Any, friction: Any, row: Any) -> None:
    """Write positions, velocities and friction of a step."""
    count = motion.shape[1]
    for i in range(count):
        row[i], row[count + i] = motion[0, i], motion[1, i]
    for i in range(friction.size):
        row[2 * count + i] = -friction[i]
