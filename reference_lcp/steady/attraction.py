"""Whether the steady state of a chain with a cell without dashpot attracts: the multipliers of its period map.

Friction with given normal forces and one coefficient is monotone: the energy norm of the difference of two motions
never grows. With a chain dashpot in every cell, all periodic motions then have one transmittance, and every motion
tends to one of them: a difference that lasts moves no dashpot, and stays that of contacts that stick. Without dashpots
free oscillations may last.
"""

import dataclasses
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from reference_lcp.chain.simulation import Lane, OrbitStatus, PeriodicOrbit, Simulation
from reference_lcp.steady.anderson import StateScales
from reference_lcp.validation import FloatArray

OFFSET = 1e-7
"""Change of each component, over its scale, with which a Jacobian is taken: ten times the residual that certifies an
orbit. The map is affine between changes of mode: the quotient's only error is round-off, 1e-9."""

OPEN_GAP = 1e-9
"""Scaled gap, or its rate, above which a contact is open, or moves: far above round-off, far below a flight."""

NEUTRAL = 1e-6
"""Distance of a multiplier from one that counts as none: far above the round-off of a quotient with `OFFSET`, and a
growth that no motion shows in 10,000 periods."""

STANDING = 1e-3
"""Largest distance of a multiplier from one, and largest part of its direction, of length one, that may be velocities
over their scales, of offsets that last: those of cells that stay stuck, and of masses so heavy that they stand."""


class Stability(StrEnum):
    """What becomes of a small distance from a steady state."""

    ATTRACTS = "attracts"
    """It vanishes, but for offsets of contacts that stay stuck."""
    NEUTRAL = "is neutral"
    """It lasts."""
    REPELS = "repels"
    """It grows."""

    @classmethod
    def of(cls, multiplier: float) -> "Stability":
        """Read the largest multiplier."""
        if multiplier > 1 + NEUTRAL:
            return cls.REPELS
        return cls.ATTRACTS if multiplier < 1 - NEUTRAL else cls.NEUTRAL


def attracts_all(lane: Lane) -> bool:
    """Whether every motion tends to the steady state, where friction is monotone: with a dashpot in every cell."""
    return bool(np.all(lane.chain.chain_damping > 0))


def without_dashpots(orbit: PeriodicOrbit, multiplier: float) -> PeriodicOrbit:
    """Judge a steady state of monotone friction in a chain with a cell without dashpot by its largest multiplier.

    One that attracts does so from everywhere; one that does not is no steady state that is reached.
    """
    stability = Stability.of(multiplier)
    known = f"{stability}, largest multiplier {multiplier:.7g}"
    if stability is Stability.ATTRACTS:
        return dataclasses.replace(orbit, reason=f"not every cell has a dashpot: {known}")
    many = f"not every cell has a dashpot: the steady state is one of many, or none is reached ({known})"
    return dataclasses.replace(orbit, status=OrbitStatus.PERIOD_LIMIT, reason=many)


def largest_multiplier(simulation: Simulation, orbit: PeriodicOrbit) -> float:
    """Largest factor by which a small distance from an orbit of `simulation`, of one lane, grows in a period."""
    return largest_moving(_jacobian(simulation, orbit), orbit.lane.chain.cells)


def largest_moving(jacobian: FloatArray, cells: int) -> float:
    """Largest multiplier of a Jacobian of scaled states (u, v, u̇, v̇, …), but for offsets that last."""
    values, directions = np.linalg.eig(jacobian)
    speeds = np.linalg.norm(directions[2 * cells : 4 * cells], axis=0)
    moving = (np.abs(values - 1) > STANDING) | (speeds > STANDING)
    return float(np.max(np.abs(values[moving]), initial=0.0))


def _jacobian(simulation: Simulation, orbit: PeriodicOrbit) -> FloatArray:
    """Jacobian of the period map at the end of an orbit, of the scaled state's free components."""
    end, steps = orbit.trajectory.end, orbit.trajectory.steps
    scales = StateScales([orbit.lane], steps)
    scales.learn(None, end, [0])
    x = scales.vectors(end, [0])[0]
    free = _free_components(x, orbit.lane)
    offsets = np.zeros((free.size + 1, x.size))
    offsets[np.arange(1, free.size + 1), free] = OFFSET
    every = np.zeros(free.size + 1, dtype=np.intp)
    ends = simulation.subset(every).advance(scales.state(x + offsets, every), 0, steps)
    after = scales.vectors(ends, every)[:, free]
    jacobian: FloatArray = (after[1:] - after[0]).T / OFFSET
    return jacobian


def _free_components(x: FloatArray, lane: Lane) -> NDArray[np.intp]:
    """Give which components of a scaled state may change alone.

    The gap of a closed contact may not, nor its rate, unless it has landed in the last step.
    """
    motion, free = 4 * lane.chain.cells, np.ones(x.size, dtype=bool)
    if lane.opens:
        gaps, rates = x[motion:].reshape(2, lane.chain.cells)
        opened = gaps > OPEN_GAP
        free[motion:] = np.concatenate([opened, opened | (np.abs(rates) > OPEN_GAP)])
    return np.flatnonzero(free)
