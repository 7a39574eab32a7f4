"""The model of a sphere that friction lifts off the depth at which λ_N holds it, with Drake's kSap or kSimilar."""

import numpy as np

from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.stepping.linear_implicit import LinearStep
from reference_lcp.stepping.sequential import LaneModel
from reference_lcp.validation import FloatArray


class GlidingLane(LaneModel):
    """One chain of spheres; its internal state is the place of every sphere, then its place a step later.

    Parameters
    ----------
    lane, step
        The lane, and the linear part of its motion along the row.
    depth
        Of a sphere at rest [m].
    softness
        R_t [1/kg] of kSap, shape (n,); zeros for kSimilar.
    smoothing
        Velocity [m/s], shape (n,), within which friction of kSimilar is off its bound; zeros for kSap.
    """

    def __init__(
        self,
        lane: Lane,
        step: LinearStep,
        depth: float,
        *,
        softness: FloatArray | None = None,
        smoothing: FloatArray | None = None,
    ):
        chain = lane.chain
        none = np.zeros(chain.cells)
        self.lane, self._step, self._depth = lane, step, depth
        self._contact = (
            np.where(chain.friction_bound > 0, chain.friction_coefficient, 0.0),
            chain.normal_force.copy(),
            chain.inner_mass.copy(),
            none if softness is None else softness,
            none if smoothing is None else smoothing,
        )

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state` at step index `start`."""
        lane, cells = self.lane, self.lane.chain.cells
        record = np.empty((steps, 6 * cells))
        _, across = self._integrate(state, start, steps, record)
        position, velocity, friction, normal = np.split(record, [2 * cells, 4 * cells, 5 * cells], axis=1)
        return Trajectory(lane.times(start, steps), position, velocity, friction, normal, self._internal_state(across))

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance as `run` does, and keep the end only."""
        motion, across = self._integrate(state, start, steps, np.empty((0, 6 * self.lane.chain.cells)))
        return State(motion[:1], motion[1:], self._internal_state(across)[None])

    def _integrate(self, state: State, start: int, steps: int, record: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Run the kernel; gives positions and velocities at the end, shape (2, 2n), and across, (2, n)."""
        from engines.drake.pressed_sphere_kernel import advance  # numba is imported once something moves

        step, motion, across = self._step, np.vstack([state.positions[0], state.velocities[0]]), self._across(state)
        advance(
            motion,
            across,
            self.lane.loads(start, steps),
            (step.state, np.ascontiguousarray(step.load[:, 0]), step.response, step.coupling),
            (step.length, self._depth),
            self._contact,
            record,
        )
        return motion, across

    def _across(self, state: State) -> FloatArray:
        """Give places and velocities of the spheres, at rest where the state has none."""
        cells = self.lane.chain.cells
        if state.internal_state is None:
            return np.vstack([np.where(self._contact[0] > 0, -self._depth, 0.0), np.zeros(cells)])
        place, later = np.split(state.internal_state[0], 2)
        return np.vstack([place, (later - place) / self._step.length])

    def _internal_state(self, across: FloatArray) -> FloatArray:
        place, velocity = across
        return np.concatenate([place, place + self._step.length * velocity])
