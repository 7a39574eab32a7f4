"""The compiled substeps of Rapier under constant forces."""

from typing import Any

import numba
import numpy as np


@numba.njit(cache=True, error_model="numpy")
def advance(
    motion: Any, friction: Any, loads: Any, bounds: Any, force_matrix: Any, masses: Any, numbers: Any, record: Any
) -> None:
    """Advance one lane in place; `record` is (steps, 5n), or has no rows when nothing is kept.

    `friction`, shape (n,), is that of the substep before, and then of the last one, as a force; `bounds`, shape
    (steps, n), are forces; `numbers` are the length of a substep, how many make a step, whether friction is
    found before positions move; one over the largest velocity that is then left, and over the damping of motors.
    """
    h, substeps, friction_first, slowness, yielding = numbers
    cells = bounds.shape[1]
    count = 2 * cells
    position, velocity = motion[:count], motion[count:]
    total = np.empty(cells)
    for step in range(loads.size):
        force = force_matrix @ motion
        force[0] += loads[step]
        total[:] = 0.0
        for _ in range(substeps):
            velocity += h * force / masses
            if friction_first:
                _rub(velocity, friction, bounds[step], masses, h, yielding)
                _move(position, velocity, h, slowness)
            else:
                position += h * velocity
                _push(position, h * h * friction, masses)
                _rub(velocity, friction, bounds[step], masses, h, yielding)
            total += friction
        if record.shape[0] > 0:
            record[step, :count], record[step, count : 2 * count] = position, velocity
            record[step, 2 * count :] = friction if friction_first else total / substeps


@numba.njit(cache=True, error_model="numpy")
def _move(position: Any, velocity: Any, h: Any, slowness: Any) -> None:
    """Cut velocities off, and let positions move by them."""
    for mass in range(velocity.size):
        velocity[mass] /= max(1.0, slowness * abs(velocity[mass]))
        position[mass] += h * velocity[mass]


@numba.njit(cache=True, error_model="numpy")
def _rub(velocity: Any, friction: Any, bounds: Any, masses: Any, h: Any, yielding: Any) -> None:
    """Find the forces that bring every cell to rest, within their bounds, and let them act."""
    cells = friction.size
    for cell in range(cells):
        slip = velocity[cells + cell] - velocity[cell]
        stopping = -slip / (h * (1 / masses[cell] + 1 / masses[cells + cell]) + yielding)
        friction[cell] = min(max(stopping, -bounds[cell]), bounds[cell])
    _push(velocity, h * friction, masses)


@numba.njit(cache=True, error_model="numpy")
def _push(moved: Any, impulse: Any, masses: Any) -> None:
    """Add what impulses on the inner masses, and back on the outer ones, make."""
    cells = impulse.size
    moved[:cells] -= impulse / masses[:cells]
    moved[cells:] += impulse / masses[cells:]
