"""Models of laws whose steps a compiled kernel takes, and of which positions and velocities are the whole state."""

from abc import abstractmethod

import numpy as np

from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.stepping.sequential import LaneModel
from reference_lcp.validation import FloatArray


class KernelLane(LaneModel):
    """One chain; an adapter's model adds the kernel and its numbers.

    Parameters
    ----------
    lane
        The lane.
    """

    def __init__(self, lane: Lane):
        chain = lane.chain
        self.lane = lane
        self._force = -np.hstack([chain.stiffness_matrix, chain.damping_matrix])
        self._masses = np.concatenate([chain.outer_mass, chain.inner_mass])

    @abstractmethod
    def _take(self, motion: FloatArray, loads: FloatArray, bounds: FloatArray, record: FloatArray) -> None:
        """Take a step for each load.

        Parameters
        ----------
        motion
            Positions and velocities, shape (4n,), which become those of the end.
        loads, bounds
            Force on cell 1 and μ λ_N of every contact in each step, shapes (steps,) and (steps, n).
        record
            Gets positions, velocities and friction of each step, shape (steps, 5n); without rows, nothing is written.
        """

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state` at step index `start`."""
        lane, size = self.lane, 2 * self.lane.chain.cells
        record = np.empty((steps, 5 * lane.chain.cells))
        self._integrate(state, start, steps, record)
        columns = record[:, :size], record[:, size : 2 * size], record[:, 2 * size :]
        return Trajectory(lane.times(start, steps), *columns, lane.preloads(start, steps))

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance as `run` does, and keep the end only."""
        return self._integrate(state, start, steps, np.empty((0, 5 * self.lane.chain.cells)))

    def _integrate(self, state: State, start: int, steps: int, record: FloatArray) -> State:
        lane = self.lane
        motion = np.concatenate([state.positions[0], state.velocities[0]])
        bounds = np.ascontiguousarray(lane.chain.friction_coefficient * lane.preloads(start, steps))
        self._take(motion, lane.loads(start, steps), bounds, record)
        position, velocity = np.split(motion[None], 2, axis=1)
        return State(position, velocity)
