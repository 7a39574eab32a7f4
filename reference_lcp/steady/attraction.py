"""Whether the steady state of a chain with a cell without dashpot attracts: the multipliers of its period map.

Friction with given normal forces and one coefficient is monotone: the energy norm of the difference of two motions
never grows. With a chain dashpot in every cell, all periodic motions then have one transmittance, and every motion
tends to one of them: a difference that lasts moves no dashpot, and stays that of contacts that stick. Without dashpots
free oscillations may last.
"""

import dataclasses
from collections.abc import Sequence

import numpy as np

from reference_lcp.chain.simulation import OrbitStatus, PeriodicOrbit, Simulation
from reference_lcp.chain.trajectory import State
from reference_lcp.steady.anderson import StateScales
from reference_lcp.validation import FloatArray

OFFSET = 1e-7
"""Change of each component, over its scale, with which a Jacobian is taken: ten times the residual that certifies an
orbit. The map is affine between changes of mode: the quotient's only error is round-off, 1e-9."""

NEUTRAL = 1e-6
"""Distance of a multiplier from one that counts as none: far above the round-off of a quotient with `OFFSET`, and a
growth that no motion shows in 10,000 periods."""

STANDING = 1e-3
"""Largest distance of a multiplier from one, and largest part of its direction, of length one, that may be velocities
over their scales, of offsets that last: those of cells that stay stuck, and of masses so heavy that they stand."""


def without_dashpots(orbit: PeriodicOrbit, multiplier: float) -> PeriodicOrbit:
    """Judge a steady state of monotone friction in a chain with a cell without dashpot by its largest multiplier.

    One that attracts does so from everywhere; one that does not is no steady state that is reached.
    """
    neutral = abs(multiplier - 1) <= NEUTRAL
    words = "is neutral" if neutral else "attracts" if multiplier < 1 else "repels"
    why = "dashpots do not resist every motion"
    known = f"{words}, largest multiplier {multiplier:.7g}"
    if multiplier < 1 - NEUTRAL:
        return dataclasses.replace(orbit, reason=f"{why}: {known}")
    many = f"{why}: the steady state is one of many, or none is reached ({known})"
    return dataclasses.replace(orbit, status=OrbitStatus.PERIOD_LIMIT, reason=many)


def largest_multiplier(jacobian: FloatArray) -> float:
    """Largest factor by which a small distance grows in a period, by the Jacobian of scaled positions and velocities.

    Offsets that last do not count.
    """
    values, directions = np.linalg.eig(jacobian)
    speeds = np.linalg.norm(directions[len(jacobian) // 2 :], axis=0)
    moving = (np.abs(values - 1) > STANDING) | (speeds > STANDING)
    return float(np.max(np.abs(values[moving]), initial=0.0))


def jacobians(simulation: Simulation, orbits: Sequence[PeriodicOrbit]) -> FloatArray:
    """Jacobians of the period maps at the ends of the orbits, shape (orbits, 4n, 4n): all of them in one batch."""
    lanes, steps = [orbit.lane for orbit in orbits], orbits[0].trajectory.steps
    width = 2 * lanes[0].chain.freedoms
    scales, every = StateScales(lanes, steps), np.repeat(np.arange(len(lanes)), width + 1)
    end = State.stack([orbit.trajectory.end for orbit in orbits])
    vectors = scales.vectors(State(end.positions, end.velocities), np.arange(len(lanes)))
    offsets = np.vstack([np.zeros(width), OFFSET * np.eye(width)])
    moved = scales.state((vectors[:, None] + offsets).reshape(-1, width), every)
    gaps = None if end.internal_state is None else end.internal_state[every]
    ends = simulation.subset(every).advance(State(moved.positions, moved.velocities, gaps), 0, steps)
    after = scales.vectors(State(ends.positions, ends.velocities), every).reshape(len(lanes), width + 1, width)
    jacobian: FloatArray = (after[:, 1:] - after[:, :1]).swapaxes(1, 2) / OFFSET
    return jacobian
