"""The period map close to a steady state: how far a motion is from there, beside how far one period shows that it is.

A motion that comes back after a period by r beside where it was is (I − J)⁺ r from the steady state, J being the
Jacobian of the period map of the Euler scheme there: of the free modes and of the modes in which contacts stick, for
as long as they do in a period.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from reference_lcp.chain.trajectory import State
from reference_lcp.steady.orbits import PeriodicOrbit
from reference_lcp.steady.state_scales import StateScales
from reference_lcp.stepping.euler import euler_simulation
from reference_lcp.validation import FloatArray

OFFSET = 1e-7
"""Change of each position and velocity, over their scales, with which the Jacobian is taken.

Between changes of stick and slip the period map is affine, so that the quotient has no error but round-off, 1e-9; ten
times the residual that certifies an orbit, so that contacts change where they do in it.
"""

LASTING = 1e-4
"""Singular values of I − J below this belong to offsets that last, if what they move is at rest.

Those are offsets of cells that stay stuck, of which round-off leaves 1e-6, and of masses so heavy that they stand. They
change no amplitude, and are no error. Where a cell slips, to and fro, it forgets an offset within a period.
"""

AT_REST = 1e-3
"""Largest part of a direction, of length one, that may be velocities, over their scales, in an offset that lasts."""


@dataclass(frozen=True)
class PeriodInverse:
    """What the residual of a period says of the distance from the steady state, for several orbits.

    Parameters
    ----------
    distance
        (I − J)⁺, shape (orbits, 4n, 4n), for scaled states as those of `StateScales`.
    unexplained
        Projector on the residuals that no distance makes, of the same shape; zero where no cell stays stuck.
    """

    distance: FloatArray
    unexplained: FloatArray

    @classmethod
    def of(cls, orbits: Sequence[PeriodicOrbit]) -> "PeriodInverse":
        """Take the Jacobians of the orbits together; their number of cells and of steps a period is the same."""
        width = 4 * orbits[0].lane.chain.cells
        left, sizes, right = np.linalg.svd(np.eye(width) - _jacobians(orbits))
        at_rest = np.linalg.norm(right[:, :, width // 2 :], axis=2) < AT_REST
        lasts = (sizes < LASTING) & at_rest
        shown = np.where(lasts, 0.0, 1 / np.where(lasts, 1.0, sizes))
        outside = np.where(lasts[:, None], left, 0.0)
        distance = (right.swapaxes(1, 2) * shown[:, None]) @ left.swapaxes(1, 2)
        return cls(distance, outside @ outside.swapaxes(1, 2))

    @property
    def newton(self) -> FloatArray:
        """Newton's step from a residual, shape (orbits, 4n, 4n); plain where cells stay stuck."""
        return self.distance + self.unexplained

    @property
    def amplification(self) -> FloatArray:
        """Largest component of a distance over that of its residual, at least 1, shape (orbits,)."""
        largest: FloatArray = np.maximum(1.0, np.max(np.sum(np.abs(self.distance), axis=2), axis=1))
        return largest


def residual_amplification(orbit: PeriodicOrbit) -> float:
    """How many times farther from the steady state a motion may be than its residual; >= 1.

    The norm is the residual's, the largest component of a scaled state.

    Parameters
    ----------
    orbit
        Of the Euler scheme, or of one near to it.
    """
    return float(PeriodInverse.of([orbit]).amplification[0])


def _jacobians(orbits: Sequence[PeriodicOrbit]) -> FloatArray:
    """Jacobians of the period maps at the ends of the orbits, shape (orbits, 4n, 4n): all of them in one batch."""
    lanes, steps = [orbit.lane for orbit in orbits], orbits[0].trajectory.steps
    width = 4 * lanes[0].chain.cells
    scales, every = StateScales(lanes, steps), np.repeat(np.arange(len(lanes)), width + 1)
    end = State.stack([orbit.trajectory.end for orbit in orbits])
    vectors = scales.vectors(State(end.positions, end.velocities), np.arange(len(lanes)))
    offsets = np.vstack([np.zeros(width), OFFSET * np.eye(width)])
    moved = scales.state((vectors[:, None] + offsets).reshape(-1, width), every)
    gaps = None if end.internal_state is None else end.internal_state[every]
    simulation = euler_simulation(lanes).subset(every)
    ends = simulation.advance(State(moved.positions, moved.velocities, gaps), 0, steps)
    after = scales.vectors(State(ends.positions, ends.velocities), every).reshape(len(lanes), width + 1, width)
    return (after[:, 1:] - after[:, :1]).swapaxes(1, 2) / OFFSET
