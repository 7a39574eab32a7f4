"""The compiled substeps of Rapier under constant forces."""

from typing import Any

import numba
import numpy as np


@numba.njit(cache=True, error_model="numpy")
def advance(
    motion: Any, loads: Any, bounds: Any, force_matrix: Any, masses: Any, reported: Any, h: Any, record: Any
) -> None:
    """Advance one lane in place by substeps of length h; `record` is (steps, 5n), or has no rows when nothing is kept.

    `bounds`, shape (steps, n), are forces; `reported`, shape (substeps,), weighs the friction of the substeps.
    """
    outer, inner = masses[0], masses[1]
    cells = outer.size
    count = 2 * cells
    position, velocity, friction = motion[:count], motion[count:], np.empty(cells)
    for step in range(loads.size):
        force = force_matrix @ motion
        force[0] += loads[step]
        friction[:] = 0.0
        for substep in range(reported.size):
            for cell in range(cells):
                first = velocity[cell] + h * force[cell] / outer[cell]
                second = velocity[cells + cell] + h * force[cells + cell] / inner[cell]
                stop = (first - second) / (h * (1 / outer[cell] + 1 / inner[cell]))
                value = min(max(stop, -bounds[step, cell]), bounds[step, cell])
                velocity[cell] = first - h * value / outer[cell]
                velocity[cells + cell] = second + h * value / inner[cell]
                friction[cell] += reported[substep] * value
            position += h * velocity
        if record.shape[0] > 0:
            record[step, :count], record[step, count : 2 * count] = position, velocity
            record[step, 2 * count :] = friction
