"""The compiled steps of SolverSteel's friction anchors."""

from typing import Any

import numba
import numpy as np


@numba.njit(cache=True, error_model="numpy")
def advance(motion: Any, loads: Any, bounds: Any, force_matrix: Any, masses: Any, numbers: Any, record: Any) -> None:
    """Advance one lane in place; `record` is (steps, 5n), or has no rows when nothing is kept.

    `bounds`, shape (steps, n), are forces; `numbers` are the time step, the part of a displacement that is taken back
    in a step, the part of its bound and the slip velocity from which friction lets go of its anchor.
    """
    h, gain, saturation, slipping = numbers
    cells = bounds.shape[1]
    count = 2 * cells
    position, velocity = motion[:count], motion[count:]
    displacement, friction = np.zeros(cells), np.zeros(cells)
    for step in range(loads.size):
        force = force_matrix @ motion
        force[0] += loads[step]
        velocity += h * force / masses
        for cell in range(cells):
            outer, inner, bound = masses[cell], masses[cells + cell], bounds[step, cell]
            slip = velocity[cells + cell] - velocity[cell]
            stopping = -(slip + gain * displacement[cell] / h) / (h * (1 / outer + 1 / inner))
            friction[cell] = min(max(stopping, -bound), bound)
            velocity[cell] -= h * friction[cell] / outer
            velocity[cells + cell] += h * friction[cell] / inner
            slip = velocity[cells + cell] - velocity[cell]
            slips = abs(friction[cell]) >= saturation * bound and slip * friction[cell] < -bound * slipping
            displacement[cell] = 0.0 if slips or bound <= 0 else displacement[cell] + h * slip
        position += h * velocity
        if record.shape[0] > 0:
            record[step, :count], record[step, count : 2 * count] = position, velocity
            record[step, 2 * count :] = friction
