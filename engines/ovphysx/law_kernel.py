"""The compiled substeps of joints in the temporal Gauss–Seidel solver."""

from typing import Any

import numba
import numpy as np


@numba.njit(cache=True, error_model="numpy")
def advance(
    motion: Any, loads: Any, bounds: Any, force_matrix: Any, masses: Any, stopping: Any, numbers: Any, record: Any
) -> None:
    """Advance one lane in place; `record` is (steps, 5n), or has no rows when nothing is kept.

    `bounds`, shape (steps, n), are forces; `stopping`, shape (n,), are impulses over the slip velocity that they are to
    stop; `numbers` are the time step, how many substeps make one, and how often velocities are corrected after them.
    """
    step_length, substeps, corrections = numbers
    h, cells = step_length / substeps, bounds.shape[1]
    count = 2 * cells
    position, velocity = motion[:count], motion[count:]
    impulse, total = np.empty(cells), np.empty(cells)
    for step in range(loads.size):
        force = force_matrix @ motion
        force[0] += loads[step]
        total[:] = 0.0
        for _ in range(substeps):
            velocity += h * force / masses
            impulse[:] = 0.0
            _rub(velocity, impulse, h * bounds[step], masses, stopping)
            total += impulse
            position += h * velocity
        for _ in range(corrections):
            _rub(velocity, total, step_length * bounds[step], masses, stopping)
        if record.shape[0] > 0:
            record[step, :count], record[step, count : 2 * count] = position, velocity
            record[step, 2 * count :] = total / step_length


@numba.njit(cache=True, error_model="numpy")
def _rub(velocity: Any, impulse: Any, bounds: Any, masses: Any, stopping: Any) -> None:
    """Bring the impulse of every cell nearer to that which stops it, within its bound."""
    cells = impulse.size
    for cell in range(cells):
        wanted = impulse[cell] - stopping[cell] * (velocity[cells + cell] - velocity[cell])
        given = min(max(wanted, -bounds[cell]), bounds[cell])
        velocity[cell] -= (given - impulse[cell]) / masses[cell]
        velocity[cells + cell] += (given - impulse[cell]) / masses[cells + cell]
        impulse[cell] = given
