"""The compiled substeps of the temporal Gauss–Seidel solver."""

from typing import Any

import numba
import numpy as np


@numba.njit(cache=True, error_model="numpy")
def advance(motion: Any, loads: Any, bounds: Any, force_matrix: Any, masses: Any, numbers: Any, record: Any) -> None:
    """Advance one lane in place; `record` is (steps, 5n), or has no rows when nothing is kept.

    `bounds`, shape (steps, n), are forces; `numbers` are the time step, how many substeps make one, how often
    velocities are corrected after them, and the relaxation.
    """
    h, substeps, corrections, relaxation = numbers
    cells = bounds.shape[1]
    count = 2 * cells
    position, velocity = motion[:count], motion[count:]
    drift, impulse, moved = np.zeros(cells), np.zeros(cells), np.zeros(count)
    stuck = np.ones(cells, dtype=np.bool_)
    for step in range(loads.size):
        force = force_matrix @ motion
        force[0] += loads[step]
        velocity += h * force / masses
        impulse[:], moved[:] = 0.0, 0.0
        for sweep in range(substeps + corrections):
            slipped = drift + moved[cells:] - moved[:cells]
            _rub(velocity, impulse, stuck, h * bounds[step], slipped * substeps / h, masses, relaxation)
            if sweep < substeps:
                moved += velocity * (h / substeps)
        position += moved
        drift[:] = np.where(stuck, drift + moved[cells:] - moved[:cells], 0.0)
        if record.shape[0] > 0:
            record[step, :count], record[step, count : 2 * count] = position, velocity
            record[step, 2 * count :] = impulse / h


@numba.njit(cache=True, error_model="numpy")
def _rub(velocity: Any, impulse: Any, stuck: Any, bounds: Any, drawing_back: Any, masses: Any, relaxation: Any) -> None:
    """Bring the impulse of every cell nearer to that which stops it and draws it back, within its bound."""
    cells = impulse.size
    for cell in range(cells):
        outer, inner = masses[cell], masses[cells + cell]
        slip = velocity[cells + cell] - velocity[cell] + relaxation * drawing_back[cell]
        wanted = impulse[cell] - relaxation * slip / (1 / outer + 1 / inner)
        given = min(max(wanted, -bounds[cell]), bounds[cell])
        stuck[cell] = given == wanted
        velocity[cell] -= (given - impulse[cell]) / outer
        velocity[cells + cell] += (given - impulse[cell]) / inner
        impulse[cell] = given
