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
from reference_lcp.stepping.euler_compiled import CompiledSimulation
from reference_lcp.validation import FloatArray

OFFSET = 1e-7
"""Change of each position and velocity, over their scales, with which the Jacobian is taken.

Between changes of stick and slip the period map is affine, so that the quotient has no error but round-off, 1e-9; ten
times the residual that certifies an orbit, so that contacts change where they do in it.
"""

LASTING = 1e-4
"""Columns of I − J shorter than this belong to offsets of cells that stay stuck: they last, and are no error.

Round-off leaves 1e-6 of them; where a cell slips, to and fro, it forgets an offset within a period, and leaves about 1.
"""


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
        change = np.eye(4 * orbits[0].lane.chain.cells) - _jacobians(orbits)
        lasts = np.linalg.norm(change, axis=1) < LASTING
        last = np.argsort(lasts, axis=1, kind="stable")
        lasts = np.take_along_axis(lasts, last, axis=1)
        columns = np.where(lasts[:, None], 0.0, np.take_along_axis(change, last[:, None], axis=2))
        q, r = np.linalg.qr(columns)
        rows = np.linalg.inv(r + lasts[:, None] * np.eye(r.shape[1])) @ q.swapaxes(1, 2)
        outside = np.where(lasts[:, :, None], rows, 0.0)
        distance = np.empty_like(rows)
        np.put_along_axis(distance, last[:, :, None], rows - outside, axis=1)
        return cls(distance, outside.swapaxes(1, 2) @ outside)

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
    simulation = CompiledSimulation(lanes).subset(every)
    ends = simulation.advance(State(moved.positions, moved.velocities, gaps), 0, steps)
    after = scales.vectors(State(ends.positions, ends.velocities), every).reshape(len(lanes), width + 1, width)
    return (after[:, 1:] - after[:, :1]).swapaxes(1, 2) / OFFSET
