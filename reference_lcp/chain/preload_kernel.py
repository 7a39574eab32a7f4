"""The compiled steps of the normal direction."""

from typing import Any

import numba
import numpy as np


@numba.njit(cache=True, nogil=True, error_model="numpy")
def advance_normal(normal_load: Any, mass: Any, time_step: Any, start: Any, rate: Any) -> Any:
    """Advance contacts, shape (k,), through the rows of `normal_load`; gives forces, gaps and final rates."""
    force, gaps = np.zeros_like(normal_load), np.zeros_like(normal_load)
    gap, speed = start.copy(), rate.copy()
    for step in range(normal_load.shape[0]):
        for k in range(normal_load.shape[1]):
            dt, pressing = time_step[k], normal_load[step, k]
            needed = pressing - mass[k] * (speed[k] + gap[k] / dt) / dt
            if needed > 0.0:
                force[step, k] = needed
                speed[k] = -gap[k] / dt
                gap[k] = 0.0
            else:
                speed[k] -= dt * pressing / mass[k]
                gap[k] += dt * speed[k]
            gaps[step, k] = gap[k]
    return force, gaps, speed
