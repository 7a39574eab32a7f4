"""Newton's method on the event-driven period map, with its exact Jacobian.

The Jacobian (monodromy matrix) of a piecewise smooth flow is the product of the propagators of its
segments and, at each event, of a saltation matrix S = I + (f⁺ − f⁻) hᵀ / (hᵀ f⁻), with h the gradient
of the event function and f the rate of the state before and after (Leine and Nijmeijer, "Dynamics and
bifurcations of non-smooth mechanical systems", 2004, chapter 7). Where a sticking contact starts to slip
the rate is continuous and S = I; where a slipping one stops or turns round, h is its relative velocity.
"""

from itertools import pairwise

import numpy as np

from reference_lcp.chain.trajectory import State
from reference_lcp.exact.event_driven import EventDrivenChain, EventDrivenSimulation
from reference_lcp.exact.mode_dynamics import PiecewiseLinearChain, Segment
from reference_lcp.steady.orbits import OrbitStatus, PeriodicOrbit, periodic_orbits
from reference_lcp.validation import FloatArray

NEWTON_STEPS = 12
"""Most steps of Newton's method; from a residual of 1e-8 one or two reach round-off.

Where a contact creeps towards a place in which its force just reaches the bound, the fixed point is a
double one: each step then lowers the residual by four only, and twelve lower it by 10^7.
"""

NULL_DIRECTION = 1e-12
"""Singular values of I − J, over the largest, that belong to offsets of cells that stay stuck.

These are zero but for round-off; the least damped motion of a chain with ζ = 1e-6 is far above.
"""


def monodromy_matrix(chain: EventDrivenChain, segments: list[Segment]) -> FloatArray:
    """Jacobian of the end of a row of segments to its start, in (u, v, u̇, v̇), shape (4n, 4n).

    Contacts that stick at the start have one velocity for both masses; a change of it that parts them
    counts for its common part.
    """
    n = chain.lane.chain.cells
    outer, inner = 2 * n + np.flatnonzero(segments[0].modes == 0), 3 * n + np.flatnonzero(segments[0].modes == 0)
    total = np.eye(4 * n)
    share = chain.outer_share[segments[0].modes == 0, None]
    total[outer] = total[inner] = share * total[outer] + (1 - share) * total[inner]
    total = chain.system.propagator(segments[0].modes == 0, segments[0].duration) @ total
    for before, after in pairwise(segments):
        total = _saltation(chain.system, before, after) @ total
        total = chain.system.propagator(after.modes == 0, after.duration) @ total
    return total


def _saltation(system: PiecewiseLinearChain, before: Segment, after: Segment) -> FloatArray:
    """Saltation matrix of the contacts that stop or turn round between two segments, shape (4n, 4n)."""
    n = before.cells
    matrix = np.eye(4 * n)
    stopping = np.flatnonzero((before.modes != 0) & (after.modes != before.modes))
    if stopping.size == 0:
        return matrix
    rate = system.rates(before.end_vector, before.modes == 0)
    jump = system.rates(after.coefficients[0], after.modes == 0) - rate
    for cell in stopping:
        outer, inner = 2 * n + cell, 3 * n + cell
        slip_acceleration = rate[inner] - rate[outer]
        for mass in (outer, inner):
            matrix[mass, inner] += jump[mass] / slip_acceleration
            matrix[mass, outer] -= jump[mass] / slip_acceleration
    return matrix


def polished(orbit: PeriodicOrbit, steps_per_period: int, tolerance: float) -> PeriodicOrbit:
    """Improve an orbit by Newton's method while its residual falls; `tolerance` decides the status.

    Each step is certified by plain periods, as every orbit is. Where modes change from one iterate to the
    next a step may not help; the better orbit is then kept.
    """
    if orbit.status is OrbitStatus.DIVERGED:
        return orbit
    simulation = EventDrivenSimulation([orbit.lane])
    periods = orbit.periods
    best, state = orbit, orbit.trajectory.end
    for _ in range(NEWTON_STEPS):
        state = _newton_step(EventDrivenChain(orbit.lane), state, steps_per_period * orbit.lane.time_step)
        candidate = periodic_orbits(
            simulation, steps_per_period, start=state, tolerance=tolerance, max_periods=1, longest_multiple=1
        )[0]
        periods += 1 + candidate.periods
        if not candidate.residual < best.residual:
            break
        best, state = candidate, candidate.trajectory.end
    status = best.status if best.residual > tolerance else OrbitStatus.CONVERGED
    return PeriodicOrbit(best.lane, best.trajectory, best.residual, periods, status)


def _newton_step(chain: EventDrivenChain, state: State, period: float) -> State:
    """X + (I − J)⁺ (g(x) − x) with g the period map; offsets of stuck cells stay as they are."""
    width = 2 * chain.lane.chain.cells
    segments = list(chain.segments(state, 0.0, period))
    x = np.concatenate([state.positions[0], state.velocities[0]])
    change = segments[-1].states(np.array([segments[-1].duration]))[0] - x
    scale = np.repeat([1.0, 2 * np.pi / period], width)
    matrix = np.eye(2 * width) - monodromy_matrix(chain, segments) * scale / scale[:, None]
    x = x + scale * np.linalg.lstsq(matrix, change / scale, rcond=NULL_DIRECTION)[0]
    return State(x[None, :width], x[None, width:])
