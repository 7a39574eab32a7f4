"""The model of a sphere on a plate with a pyramid of four soft edges: free across the row, or in one that is turned."""

import math
from collections.abc import Mapping

import numpy as np

from engines.mujoco.model import DEPTH, LEAST_COEFFICIENT, TOUCH
from engines.shared.units import power_of_two
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.stepping.linear_implicit import LinearStep
from reference_lcp.stepping.sequential import LaneModel
from reference_lcp.validation import FloatArray


class PyramidLane(LaneModel):
    """One chain of spheres on plates, whose edges may let friction press and lift.

    A lane with a preload has spheres that are free across the row, and a state with their gaps; others are held.

    Parameters
    ----------
    lane, step
        The lane; its linear step with b w in what friction sees.
    rate
        b [1/s].
    constants
        Those of `solimp`.
    """

    def __init__(self, lane: Lane, step: LinearStep, rate: float, constants: Mapping[str, float]):
        chain, free = lane.chain, lane.preload is not None
        self.lane, self._free = lane, free
        size = 2 * chain.cells
        self._matrices = (step.state.copy(), step.load[:, 0].copy(), step.response[:size].copy())
        depth = (TOUCH if free else DEPTH) * power_of_two(lane.drive.displacement_scale(chain))
        touching = np.full(chain.cells, depth) if free else np.where(chain.friction_bound > 0, depth, 0.0)
        self._numbers = (lane.time_step, rate, touching)
        sine, cosine = math.sin(lane.inclination), math.cos(lane.inclination)
        self._normal, tangent = np.array([-sine, 0.0, cosine]), np.array([cosine, 0.0, sine])
        solimp = (constants["d_0"], constants["d_max"], constants["δ"])
        # the critical damping of MuJoCo's default; where spheres are held, what they press with takes its place
        constraint = (lane.time_step * rate**2 / 4 if free else 0.0, *solimp)
        edges = _edges(lane, self._normal)
        self._contacts = (_masses(lane), self._normal, tangent, edges, constraint)

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state` at step index `start`."""
        lane, cells = self.lane, self.lane.chain.cells
        record = np.empty((steps, 7 * cells))
        end = self._integrate(state, start, steps, record)
        position, velocity, friction, pressed, gap = np.split(record, np.array([2, 4, 5, 6]) * cells, axis=1)
        internal_state = None if end.internal_state is None else end.internal_state[0]
        gaps = gap if self._free else None
        return Trajectory(lane.times(start, steps), position, velocity, friction, pressed, internal_state, gaps)

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance as `run` does, and keep the end only."""
        return self._integrate(state, start, steps, np.empty((0, 7 * self.lane.chain.cells)))

    def _integrate(self, state: State, start: int, steps: int, record: FloatArray) -> State:
        """Run the kernel; what moves across the row in the plane of contacts begins at rest, as in MuJoCo."""
        from engines.mujoco.pyramid_kernel import advance  # numba is imported once something moves

        lane, cells, (along, _, above) = self.lane, self.lane.chain.cells, self._normal
        motion = np.vstack([state.positions[0], state.velocities[0]])
        aside = np.zeros((cells, 3))
        if self._free:
            slips = motion[:, cells:] - motion[:, :cells]
            gaps = np.vstack([part[0] for part in state.normal_state(cells)])
            aside[:, 1:] = ((gaps - along * slips) / above).T
        loads, presses = lane.loads(start, steps), np.ascontiguousarray(lane.preloads(start, steps))
        advance(motion, aside, loads, presses, self._matrices, self._numbers, self._contacts, record)
        if not self._free:
            return State(motion[:1], motion[1:])
        gaps = above * aside[:, 1:].T + along * (motion[:, cells:] - motion[:, :cells])
        return State(motion[:1], motion[1:], gaps.reshape(1, -1))


def _edges(lane: Lane, normal: FloatArray) -> FloatArray:
    """Give the edges n ± μ t of every contact, shape (n, 4, 3): along the row, across it in its plane, out of that.

    Tangents have the directions of the world, whatever that of the row.
    """
    along, aside = lane.axis
    tangents = np.array([[along * normal[2], -aside, -normal[0]], [aside, along, 0.0]])
    coefficient = np.maximum(lane.chain.friction_coefficient, LEAST_COEFFICIENT)
    edges: FloatArray = normal + coefficient[:, None, None] * np.vstack([tangents, -tangents])
    return edges


def _masses(lane: Lane) -> FloatArray:
    """Give the inverse masses of every contact in its three directions, and R d / (1 − d) of its edges; shape (n, 4).

    MuJoCo takes the inverse mass of a body as a mean over three axes: an outer mass slides along one of them, an inner
    one along two or, where it is free, three.
    """
    chain = lane.chain
    outer, inner = 1 / chain.outer_mass, 1 / chain.inner_mass
    above = inner if lane.preload is not None else np.zeros(chain.cells)
    coefficient = np.maximum(chain.friction_coefficient, LEAST_COEFFICIENT)
    softness = 2 * coefficient**2 * (1 + coefficient**2) * (outer + 2 * inner + above) / 3
    return np.column_stack([outer + inner, inner, above, softness])
