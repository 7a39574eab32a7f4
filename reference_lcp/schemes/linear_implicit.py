"""Time steps that are linear but for a scalar friction law a contact: the steps of most engines, as models.

A step of length h takes positions q, velocities q̇ and the loads f of the drive at its start and its end to

    (q̇_free, w_free) = P (q̇, q) + h Q (f(t), f(t+h)) − h D q̇ |q̇|,
    w_i = w_free,i + Σ_j G_ij p_j,   p_i = h φ_i(w_i),
    q̇⁺ = q̇_free + R p,   q⁺ = q + h (α q̇⁺ + (1 − α) q̇),

with p the impulses of friction. The coupled scalar equations are solved by Gauss–Seidel sweeps with a closed solution a
contact: G is nearly diagonal, since a contact touches no mass of another cell. With Coulomb's law and the step of
equation (5) these are equation (7) with a given normal force, see `reference_lcp.lcp.time_step.assemble`.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.schemes.sequential import LaneModel
from reference_lcp.validation import FloatArray

WIDTH = 8
"""Numbers that the widest vectors hold: kernels have rows that are a multiple of it."""


def padded_rows(rows: FloatArray) -> FloatArray:
    """Give rows with zeros up to a multiple of `WIDTH`: what is left over of vectors takes longer than a whole one."""
    return np.pad(rows, ((0, 0), (0, -rows.shape[1] % WIDTH)))


@dataclass(frozen=True, kw_only=True)
class ScalarFriction:
    """Impulse of friction of a contact against its slip velocity w, per cell; arrays have shape (n,).

    With b the bound of the impulse: −p = w / ε up to b, and b + κ (|w| − ε b) beyond, along the slip. Coulomb's law has
    ε = κ = 0; a zone or a softness has ε > 0. A smooth law has −p = b w / √(w² + z²) instead.
    """

    compliance: FloatArray
    """ε [m/s / (N s)] >= 0."""
    slope: FloatArray
    """κ [N s / (m/s)] >= 0 beyond the bound."""
    smoothing: FloatArray
    """z [m/s] of the smooth law; zeros for the other one."""
    bound_share: float = 1.0
    """b over h μ λ_N: less than one where friction grows on beyond b."""

    @classmethod
    def coulomb(
        cls,
        cells: int,
        compliance: FloatArray | float = 0.0,
        slope: FloatArray | float = 0.0,
        bound_share: float = 1.0,
    ) -> "ScalarFriction":
        """Give Coulomb's law, softened if `compliance` is not zero."""
        return cls(
            compliance=np.broadcast_to(compliance, (cells,)).astype(float),
            slope=np.broadcast_to(slope, (cells,)).astype(float),
            smoothing=np.zeros(cells),
            bound_share=bound_share,
        )

    @classmethod
    def smooth(cls, cells: int, smoothing: FloatArray | float) -> "ScalarFriction":
        """Give the law w / √(w² + z²)."""
        none = np.zeros(cells)
        return cls(compliance=none, slope=none, smoothing=np.broadcast_to(smoothing, (cells,)).astype(float))


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
    end_weight: float
    """α of the velocity at the end of the step."""
    quadratic_drag: FloatArray
    """D, shape (2n,) [1/m]."""

    @classmethod
    def theta(cls, chain: Chain, length: float, end_weight: float) -> "LinearStep":
        """Give the θ-method for springs, dashpots and load; friction is implicit. θ = 1 is the implicit Euler step."""
        h, theta = length, end_weight
        mass, damping, stiffness = chain.mass_matrix, chain.damping_matrix, chain.stiffness_matrix
        matrix = mass + h * theta * damping + h**2 * theta**2 * stiffness
        velocity = mass - h * (1 - theta) * damping - h**2 * theta * (1 - theta) * stiffness
        return cls.of(chain, h, matrix, velocity, (1 - theta, theta), end_weight=theta)

    @classmethod
    def explicit(cls, chain: Chain, length: float) -> "LinearStep":
        """Give the step of equation (5): springs, dashpots and load as forces at its start."""
        return cls.of(chain, length, chain.mass_matrix, chain.mass_matrix - length * chain.damping_matrix, (1.0, 0.0))

    @classmethod
    def implicit(cls, chain: Chain, length: float, response_matrix: FloatArray | None = None) -> "LinearStep":
        """Give the step with springs and dashpots as forces at its end, and the load as one at its start."""
        matrix = chain.mass_matrix + length * chain.damping_matrix + length**2 * chain.stiffness_matrix
        return cls.of(chain, length, matrix, chain.mass_matrix, (1.0, 0.0), response_matrix=response_matrix)

    @classmethod
    def of(
        cls,
        chain: Chain,
        length: float,
        matrix: FloatArray,
        velocity: FloatArray,
        load: tuple[float, float],
        *,
        end_weight: float = 1.0,
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
            end_weight=end_weight,
            quadratic_drag=np.zeros(count),
        )

    def with_friction_of(self, other: "LinearStep") -> "LinearStep":
        """Give this step with friction solved in another one, whose slip velocities and coupling it sees."""
        count = self.quadratic_drag.size
        return replace(
            self,
            state=np.vstack([self.state[:count], other.state[count:]]),
            load=np.vstack([self.load[:count], other.load[count:]]),
            coupling=other.coupling,
        )


class LinearImplicitLane(LaneModel):
    """One chain under one drive, advanced by a `LinearStep` with a `ScalarFriction`: Coulomb's law without one."""

    def __init__(self, lane: Lane, step: LinearStep, friction: ScalarFriction | None = None):
        self.lane = lane
        self._step, self._friction = step, friction or ScalarFriction.coulomb(lane.chain.cells)

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state` at step index `start`."""
        lane, size = self.lane, 2 * self.lane.chain.cells
        record = np.empty((steps, 5 * lane.chain.cells))
        self._integrate(state, start, steps, record)
        friction = record[:, 2 * size :]
        return Trajectory(
            lane.times(start, steps),
            record[:, :size],
            record[:, size : 2 * size],
            friction,
            self.normal_force(friction, lane.preloads(start, steps)),
        )

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance as `run` does, and keep the end only."""
        motion = self._integrate(state, start, steps, np.empty((0, 5 * self.lane.chain.cells)))
        return State(motion[:1], motion[1:])

    def normal_force(self, friction: FloatArray, preload: FloatArray) -> FloatArray:
        """Give λ_N [N] of each step, shape (steps, n), from the friction and the preload; engines' laws override it."""
        return preload

    @cached_property
    def _constants(self) -> tuple[FloatArray | tuple[float, float], ...]:
        """Give what the kernel is handed beside a motion."""
        step, friction = self._step, self._friction
        made = padded_rows(np.hstack([step.state, step.load]).T)
        response = np.pad(step.response.T, ((0, 0), (0, made.shape[1] - len(step.response))))
        law = np.stack([friction.compliance, friction.slope, friction.smoothing])
        return made, response, step.coupling, step.quadratic_drag, (step.length, step.end_weight), law

    def _integrate(self, state: State, start: int, steps: int, record: FloatArray) -> FloatArray:
        """Run the kernel; gives positions and velocities at the end, shape (2, 2n)."""
        from reference_lcp.schemes.linear_implicit_kernel import advance  # numba is imported once something moves

        lane, step, friction = self.lane, self._step, self._friction
        bounds = friction.bound_share * step.length * lane.chain.friction_coefficient * lane.preloads(start, steps)
        motion = np.vstack([state.positions[0], state.velocities[0]])
        advance(
            motion,
            lane.loads(start, steps + 1),
            np.ascontiguousarray(bounds),
            *self._constants,
            record,
        )
        return motion
