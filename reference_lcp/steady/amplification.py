"""How far a motion is from its steady state, beside how far one period shows that it is."""

import numpy as np

from reference_lcp.chain.trajectory import State
from reference_lcp.steady.orbits import PeriodicOrbit
from reference_lcp.steady.state_scales import StateScales
from reference_lcp.stepping.euler_compiled import CompiledSimulation

OFFSET = 1e-7
"""Change of each position and velocity, over their scales, with which the Jacobian is taken.

Between changes of stick and slip the period map is affine, so that the quotient has no error but round-off, 1e-9; ten
times the residual that certifies an orbit, so that contacts change where they do in it.
"""

LASTING = 1e-6
"""Singular values of I − J below this belong to offsets of cells that stay stuck: they last, and are no error."""


def residual_amplification(orbit: PeriodicOrbit) -> float:
    """How many times farther from the steady state a motion may be than its residual; >= 1.

    A motion that comes back after a period by r beside where it was is (I − J)⁺ r from the steady state, J being the
    Jacobian of the period map of the Euler scheme there: of the free modes and of the modes in which contacts stick,
    for as long as they do in a period. The norm is the residual's, the largest component of a scaled state.

    Parameters
    ----------
    orbit
        Of the Euler scheme, or of one near to it.
    """
    lane, steps = orbit.lane, orbit.trajectory.steps
    end, width = orbit.trajectory.end, 4 * lane.chain.cells
    lanes = [lane] * (width + 1)
    scales, every = StateScales(lanes, steps), np.arange(width + 1)
    vectors = np.repeat(scales.vectors(State(end.positions, end.velocities), every[:1]), len(lanes), axis=0)
    vectors[1:, :width] += OFFSET * np.eye(width)
    moved = scales.state(vectors, every)
    gaps = np.repeat(end.internal_state, len(lanes), axis=0) if lane.opens and end.internal_state is not None else None
    begin = State(moved.positions, moved.velocities, gaps)
    ends = CompiledSimulation(lanes).advance(begin, 0, steps)
    after = scales.vectors(State(ends.positions, ends.velocities), every)
    jacobian = ((after[1:] - after[0]) / OFFSET).T
    left, sizes, right = np.linalg.svd(np.eye(width) - jacobian)
    shown = sizes > LASTING
    inverse = (right[shown].T / sizes[shown]) @ left[:, shown].T
    return max(1.0, float(np.max(np.sum(np.abs(inverse), axis=1))))
