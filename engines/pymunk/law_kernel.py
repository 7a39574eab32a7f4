"""The compiled steps of Chipmunk's damped springs."""

from typing import Any

import numba
import numpy as np


@numba.njit(cache=True, error_model="numpy")
def advance(
    motion: Any, loads: Any, bounds: Any, masses: Any, springs: Any, dashpots: Any, numbers: Any, record: Any
) -> None:
    """Advance one lane in place; `record` is (steps, 5n), or has no rows when nothing is kept."""
    h, sweeps = numbers
    position, velocity = motion[0], motion[1]
    cells = masses[0].size
    inverse_mass = np.concatenate(masses)
    for step in range(loads.size):
        position += h * velocity
        impulse = -(springs @ position)
        impulse[0] += loads[step]
        velocity += inverse_mass * impulse
        friction, chain_rate, inner_rate = np.zeros(cells), np.zeros(cells), np.zeros(cells)
        for _ in range(sweeps):
            _rub(velocity, friction, bounds[step], masses)
            _damp_chain(velocity, chain_rate, dashpots[0], masses[0])
            _damp_inner(velocity, inner_rate, dashpots[1], masses)
        if record.shape[0] > 0:
            record[step, : 2 * cells] = position
            record[step, 2 * cells : 4 * cells] = velocity
            record[step, 4 * cells :] = friction / h


@numba.njit(cache=True, error_model="numpy")
def _rub(velocity: Any, friction: Any, bounds: Any, masses: Any) -> None:
    """Bring every cell to rest, as far as the sums of its impulses are within their bounds."""
    outer, inner = masses
    cells = outer.size
    for cell in range(cells):
        slip = velocity[cells + cell] - velocity[cell]
        total = friction[cell] - slip / (outer[cell] + inner[cell])
        total = min(max(total, -bounds[cell]), bounds[cell])
        velocity[cells + cell] += inner[cell] * (total - friction[cell])
        velocity[cell] -= outer[cell] * (total - friction[cell])
        friction[cell] = total


@numba.njit(cache=True, error_model="numpy")
def _damp_chain(velocity: Any, target: Any, parts: Any, outer: Any) -> None:
    """Let the dashpots of the row act, the one to the ground first."""
    for cell in range(outer.size):
        before = velocity[cell - 1] if cell > 0 else 0.0
        inverse = outer[cell] + (outer[cell - 1] if cell > 0 else 0.0)
        rate = velocity[cell] - before
        change = (target[cell] - rate) * parts[cell]
        target[cell] = rate + change
        velocity[cell] += outer[cell] * change / inverse
        if cell > 0:
            velocity[cell - 1] -= outer[cell - 1] * change / inverse


@numba.njit(cache=True, error_model="numpy")
def _damp_inner(velocity: Any, target: Any, parts: Any, masses: Any) -> None:
    """Let the dashpots of the inner masses act."""
    outer, inner = masses
    cells = outer.size
    for cell in range(cells):
        rate = velocity[cells + cell] - velocity[cell]
        change = (target[cell] - rate) * parts[cell]
        target[cell] = rate + change
        inverse = outer[cell] + inner[cell]
        velocity[cells + cell] += inner[cell] * change / inverse
        velocity[cell] -= outer[cell] * change / inverse
