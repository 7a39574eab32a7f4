"""The compiled equations of Exudyn's contacts; see `friction_models` for what they take."""

from typing import Any

import numba
import numpy as np

from engines.exudyn.friction_models import BRISTLE, DISC, DISC_CORRECTIONS, ZONE
from reference_lcp.stepping.linear_implicit_kernel import solve_contacts


@numba.njit(cache=True, error_model="numpy")
def force_of(elongation: Any, slip: Any, contacts: Any, law: Any) -> Any:
    """Give φ of contacts whose motion is known."""
    kind, bound, first, second, _ = law
    if kind != BRISTLE:
        return bound * np.minimum(np.maximum(slip / first, -1.0), 1.0)
    stuck = (contacts[0] == 0) & (bound > 0)
    return np.where(stuck, first * (elongation - contacts[1]) + second * slip, contacts[0])


@numba.njit(cache=True, error_model="numpy")
def softness_of(law: Any) -> Any:
    """Give the laws w = −z φ / F of zones, as `solve_contacts` takes them."""
    _, bound, first, _, _ = law
    return first / bound, np.zeros(bound.size), np.zeros(bound.size)


@numba.njit(cache=True, error_model="numpy")
def solve_friction(
    elongation: Any, slip: Any, compliance: Any, mobility: Any, contacts: Any, law: Any, softness: Any, force: Any
) -> Any:
    """Give λ = −φ from x_free, w_free, P and V; `contacts` change, and a search starts from the last `force`."""
    kind, bound, first, second, tolerance = law
    if kind == ZONE:
        solve_contacts(slip, mobility, bound, softness, force)
        return force
    if kind == DISC:
        return -_correct_discs(slip, mobility, contacts[0], bound, first, tolerance)
    force = _hold_bristles(elongation, slip, compliance, mobility, contacts, (bound, first, second))
    _correct_bristles(elongation - compliance @ force, slip - mobility @ force, contacts, (bound, first, second))
    return -force


@numba.njit(cache=True, error_model="numpy")
def _correct_discs(free: Any, mobility: Any, last: Any, bound: Any, zone: Any, tolerance: Any) -> Any:
    """Give φ of discs, which are in their zone, or not, by the slip velocity of the last correction.

    In its zone a force is not cut off at the bound before the next correction.
    """
    force = np.empty(bound.size)
    for _ in range(DISC_CORRECTIONS):
        in_zone = (np.abs(last) <= zone) & (last != 0)
        rate = np.where(in_zone, bound / zone, 0.0)
        given = np.where(in_zone, 0.0, bound * np.sign(last))
        matrix = np.eye(bound.size) + rate.reshape(-1, 1) * mobility
        force = np.linalg.solve(matrix, rate * free + given)
        last[:] = free - mobility @ force
        corrected = bound * np.minimum(np.maximum(last / zone, -1.0), 1.0)
        if np.max(np.abs(corrected - force)) <= tolerance:
            break
    return force


@numba.njit(cache=True, error_model="numpy")
def _hold_bristles(elongation: Any, slip: Any, compliance: Any, mobility: Any, contacts: Any, numbers: Any) -> Any:
    """Give φ of bristles in the states that they have at the start of the substep."""
    bound, stiffness, damping = numbers
    stuck = (contacts[0] == 0) & (bound > 0)
    spring, dashpot = np.where(stuck, stiffness, 0.0), np.where(stuck, damping, 0.0)
    matrix = np.eye(bound.size) + spring.reshape(-1, 1) * compliance + dashpot.reshape(-1, 1) * mobility
    return np.linalg.solve(matrix, spring * (elongation - contacts[1]) + dashpot * slip + contacts[0])


@numba.njit(cache=True, error_model="numpy")
def _correct_bristles(elongation: Any, slip: Any, contacts: Any, numbers: Any) -> None:
    """Change the states of bristles at the end of a substep; its forces stay as they were.

    A stuck one slips where its force has passed the bound, in the direction of the slip velocity, not of the force. A
    slipping one takes its foot along; where the velocity has reversed it sticks, with the force that it had.
    """
    bound, stiffness, damping = numbers
    for i in range(bound.size):
        before, direction = contacts[0, i], np.sign(slip[i]) * bound[i]
        if before == 0 and bound[i] > 0:
            force = stiffness[i] * (elongation[i] - contacts[1, i]) + damping[i] * slip[i]
            contacts[0, i] = direction if abs(force) > bound[i] else 0.0
        elif slip[i] * before < 0:
            contacts[0, i] = 0.0
            contacts[1, i] = elongation[i] - (before - damping[i] * slip[i]) / stiffness[i]
        else:
            contacts[0, i], contacts[1, i] = direction, elongation[i]
