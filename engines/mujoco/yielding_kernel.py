"""The compiled steps of `YieldingLane`."""

from typing import Any

import numba


@numba.njit(cache=True, error_model="numpy")
def advance(
    motion: Any, deflection: Any, loads: Any, state: Any, load: Any, response: Any, length: Any, limit: Any, record: Any
) -> None:
    """Take a step for each load; `motion`, shape (2, 2n), and `deflection`, shape (n,), end in the last state."""
    size, cells = motion.shape[1], deflection.size
    keeps = record.shape[0] > 0
    free = motion[1].copy()
    for step in range(loads.size):
        for i in range(size):
            free[i] = load[i] * loads[step]
            for j in range(size):
                free[i] += state[i, j] * motion[1, j] + state[i, size + j] * motion[0, j]
            for j in range(cells):
                free[i] += response[i, j] * deflection[j]
        for i in range(size):
            motion[1, i] = free[i]
            motion[0, i] += length * free[i]
        for i in range(cells):
            slipped = deflection[i] + length * (free[cells + i] - free[i])
            deflection[i] = min(max(slipped, -limit[i]), limit[i])
        if keeps:
            record[step, :size] = motion[0]
            record[step, size : 2 * size] = motion[1]
            record[step, 2 * size :] = deflection
