"""Whether motions settle in a steady state: the multipliers of its period map.

With given normal forces friction is monotone, and every fixed point of the period map attracts. Where normal forces
depend on the motion it is not: a fixed point that is found and certified may repel what is near to it.
"""

import numpy as np
from numpy.typing import NDArray

from reference_lcp.chain.simulation import PeriodicOrbit
from reference_lcp.chain.trajectory import State
from reference_lcp.schemes.euler import euler_simulation
from reference_lcp.steady.anderson import StateScales
from reference_lcp.steady.neighbours import OFFSET
from reference_lcp.validation import FloatArray

OPEN = 1e-9
"""Scaled gap, or its rate, above which a contact is open, or moves: far above round-off, far below a flight."""


def largest_multiplier(orbit: PeriodicOrbit) -> float:
    """Largest factor by which a small distance from an orbit of the Euler scheme grows in a period.

    Below one it attracts; above, it repels. One is that of offsets that last, of contacts that stay stuck.
    """
    return float(np.max(np.abs(np.linalg.eigvals(_jacobian(orbit)))))


def _jacobian(orbit: PeriodicOrbit) -> FloatArray:
    """Jacobian of the period map at the end of an orbit, of the scaled state's free components."""
    end, steps = orbit.trajectory.end, orbit.trajectory.steps
    scales = StateScales([orbit.lane], steps)
    scales.learn(None, end, [0])
    x = scales.vectors(end, [0])[0]
    free = _free_components(x, orbit.lane.chain.cells)
    offsets = np.zeros((free.size + 1, x.size))
    offsets[np.arange(1, free.size + 1), free] = OFFSET
    every = np.zeros(free.size + 1, dtype=np.intp)
    starts: State = scales.state(x + offsets, every)
    ends = euler_simulation([orbit.lane]).subset(every).advance(starts, 0, steps)
    after = scales.vectors(ends, every)[:, free]
    jacobian: FloatArray = (after[1:] - after[0]).T / OFFSET
    return jacobian


def _free_components(x: FloatArray, cells: int) -> NDArray[np.intp]:
    """Give which components of a scaled state may change alone.

    The gap of a closed contact may not, nor its rate, unless it has landed in the last step.
    """
    motion = 4 * cells
    gaps, rates = x[motion:].reshape(2, cells)
    opened, moving = gaps > OPEN, (gaps > OPEN) | (np.abs(rates) > OPEN)
    return np.flatnonzero(np.concatenate([np.ones(motion, dtype=bool), opened, moving]))
