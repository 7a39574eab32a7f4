"""Laws that are linear but for a scalar friction law a contact: the steps of most engines.

A step of length h takes positions q, velocities q̇ and the loads f of the drive at its start and its end to

    (q̇_free, w_free) = P (q̇, q) + Q (f(t), f(t+h)) − h D q̇ |q̇|,
    w_i = w_free,i + Σ_j G_ij p_j,   p_i = h φ_i(w_i),
    q̇⁺ = q̇_free + R p,   q⁺ = q + h (α q̇⁺ + (1 − α) q̇),

with p the impulses of friction and w the slip velocities. With Coulomb's law and the step of equation (5) these are
equation (7) with a given normal force.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from multibody_xval.engines.interface.laws import Step
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray

MOST_SWEEPS = 200
"""Gauss–Seidel sweeps at most; five reach round-off where G is nearly diagonal."""

SWEPT = 1e-15
"""Largest change in a sweep, over the bound, that ends the sweeps."""

ROUND_OFF = 1e-16
"""Of a slip velocity, to which the smooth law is solved."""

Friction = Callable[[int, float, float, float], float]
"""Gives the impulse of a cell from its index, the slip velocity that it would have without it, its G_ii and bound."""


@dataclass(frozen=True, kw_only=True)
class LinearStep:
    """The linear part of a step, by matrices; see the module."""

    length: float
    """h [s]."""
    state: FloatArray
    """P, shape (3n, 4n): velocities 2n without friction, then slip velocities n as friction sees them."""
    load: FloatArray
    """Q, shape (3n, 2): for the load at the start and at the end of the step."""
    response: FloatArray
    """R, shape (2n, n)."""
    coupling: FloatArray
    """G, shape (n, n)."""
    end_weight: float = 1.0
    """α of the velocity at the end of the step."""
    quadratic_drag: float = 0.0
    """D [1/m] of every mass."""

    @classmethod
    def theta(cls, chain: Chain, length: float, theta: float) -> "LinearStep":
        """Give the θ-method for springs, dashpots and load; friction is implicit. θ = 1 is the implicit Euler step."""
        mass, damping, stiffness = chain.mass_matrix, chain.damping_matrix, chain.stiffness_matrix
        matrix = mass + length * theta * damping + length**2 * theta**2 * stiffness
        velocity = mass - length * (1 - theta) * damping - length**2 * theta * (1 - theta) * stiffness
        return replace(cls.of(chain, length, matrix, velocity, (1 - theta, theta)), end_weight=theta)

    @classmethod
    def explicit(cls, chain: Chain, length: float) -> "LinearStep":
        """Give the step of equation (5): springs, dashpots and load as forces at its start."""
        return cls.of(chain, length, chain.mass_matrix, chain.mass_matrix - length * chain.damping_matrix)

    @classmethod
    def implicit(cls, chain: Chain, length: float, response_matrix: FloatArray | None = None) -> "LinearStep":
        """Give the step with springs and dashpots as forces at its end, and the load as one at its start."""
        matrix = chain.mass_matrix + length * chain.damping_matrix + length**2 * chain.stiffness_matrix
        return cls.of(chain, length, matrix, chain.mass_matrix, response_matrix=response_matrix)

    @classmethod
    def of(
        cls,
        chain: Chain,
        length: float,
        matrix: FloatArray,
        velocity: FloatArray,
        load: tuple[float, float] = (1.0, 0.0),
        *,
        response_matrix: FloatArray | None = None,
        slip_weight: float = 0.0,
    ) -> "LinearStep":
        """Give the step S q̇⁺ = V q̇ − h K q + h (β_0 f(t) + β_1 f(t+h)) e_1 + W p.

        S is `matrix` and V `velocity` [kg], shape (2n, 2n); `load` β_0 and β_1; `response_matrix` the mass matrix under
        which friction acts, where that is not S; `slip_weight` the part of the slip velocity at the start that friction
        sees too.
        """
        count, slip = 2 * chain.cells, chain.contact_directions
        inverse = np.linalg.inv(matrix)
        response = (inverse if response_matrix is None else np.linalg.inv(response_matrix)) @ slip
        state = np.hstack([inverse @ velocity, -length * inverse @ chain.stiffness_matrix])
        loads = length * np.outer(inverse[:, 0], load)
        seen = slip.T @ state
        seen[:, :count] += slip_weight * slip.T
        return cls(
            length=length,
            state=np.vstack([state, seen]),
            load=np.vstack([loads, slip.T @ loads]),
            response=response,
            coupling=slip.T @ response,
        )

    def with_friction_of(self, other: "LinearStep") -> "LinearStep":
        """Give this step with friction solved in another one, whose slip velocities and coupling it sees."""
        count = len(self.response)
        return replace(
            self,
            state=np.vstack([self.state[:count], other.state[count:]]),
            load=np.vstack([self.load[:count], other.load[count:]]),
            coupling=other.coupling,
        )


def soft_coulomb(compliance: FloatArray | float) -> Friction:
    """Give −p = w / ε up to the bound, and the bound beyond; ε [m/s / (N s)] may be per cell, Coulomb has zero."""
    of_cell = np.atleast_1d(compliance)

    def impulse(cell: int, slip: float, coupling: float, bound: float) -> float:
        sticking = -slip / (coupling + of_cell[cell % of_cell.size])
        return min(max(sticking, -bound), bound)

    return impulse


def smooth_friction(speeds: FloatArray) -> Friction:
    """Give −p = b w / √(w² + z²) with the bound b; `speeds` are z [m/s], shape (n,)."""

    def impulse(cell: int, slip: float, coupling: float, bound: float) -> float:
        speed, most, zone = abs(slip), coupling * bound, speeds[cell]
        if speed == 0:
            return 0.0
        end = brentq(lambda w: w + most * w / np.hypot(w, zone) - speed, 0.0, speed, xtol=ROUND_OFF * speed)
        return -float(np.copysign(bound * end / np.hypot(end, zone), slip))

    return impulse


def linear_law(lane: Lane, step: LinearStep, friction: Friction | None = None) -> Step:
    """Give the step of a lane: the linear part, and friction solved by sweeps, Coulomb's unless another is given."""
    count, cells, friction = 2 * lane.chain.cells, lane.chain.cells, friction or soft_coulomb(0.0)
    directions, impulses = lane.chain.contact_directions, np.zeros(cells)

    def take(
        position: FloatArray, velocity: FloatArray, load: FloatArray, bound: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        free = step.state @ np.concatenate([velocity, position]) + step.load @ load
        drag = step.length * step.quadratic_drag * velocity * np.abs(velocity)
        slips = free[count:] - directions.T @ drag
        _sweep(slips, step.coupling, step.length * bound, friction, impulses)
        end = free[:count] - drag + step.response @ impulses
        return position + step.length * (step.end_weight * end + (1 - step.end_weight) * velocity), end

    return take


def _sweep(
    slips: FloatArray, coupling: FloatArray, bounds: FloatArray, friction: Friction, impulses: FloatArray
) -> None:
    """Solve all contacts by Gauss–Seidel sweeps, in place; sweeps start from the impulses of the step before."""
    own = coupling.diagonal()
    for _ in range(MOST_SWEEPS):
        before = impulses.copy()
        for cell in range(slips.size):
            if bounds[cell] > 0:
                slip = slips[cell] + coupling[cell] @ impulses - own[cell] * impulses[cell]
                impulses[cell] = friction(cell, float(slip), float(own[cell]), float(bounds[cell]))
            else:
                impulses[cell] = 0.0
        if np.all(np.abs(impulses - before) <= SWEPT * bounds):
            return
