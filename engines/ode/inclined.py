"""The model of contacts inclined to the row as ODE solves them: friction bounded by a normal force that knows none."""

import math

import numpy as np

from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.stepping.linear_implicit import LinearStep
from reference_lcp.stepping.sequential import LaneModel
from reference_lcp.validation import FloatArray


class NormalFirstLane(LaneModel):
    """One chain of spheres on inclined plates; the state has their gaps.

    Parameters
    ----------
    lane
        The lane, with a preload.
    erp
        Part of a depth beyond the layer that is corrected in a step.
    layer, depth
        In which a depth is left alone, and the depth at no gap, both over the displacement scale.
    """

    def __init__(self, lane: Lane, *, erp: float, layer: float, depth: float):
        chain, self.lane = lane.chain, lane
        scale = lane.drive.displacement_scale(chain)
        self._erp, self._layer, self._depth = erp, layer * scale, depth * scale
        self._step = LinearStep.explicit(chain, lane.time_step)
        sine, cosine = math.sin(lane.inclination), math.cos(lane.inclination)
        self._normal, self._tangent = np.array([-sine, cosine]), np.array([cosine, sine])
        # inverse masses of a contact along the row and across it
        self._inverse_masses = np.vstack([1 / chain.outer_mass + 1 / chain.inner_mass, 1 / chain.inner_mass])

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state` at step index `start`."""
        lane, cells, h = self.lane, self.lane.chain.cells, self.lane.time_step
        loads, presses = lane.loads(start, steps), lane.preloads(start, steps)
        position, velocity = state.positions[0].copy(), state.velocities[0].copy()
        height, rate = self._heights(state)
        rows = np.empty((steps, 7 * cells))
        for step in range(steps):
            free = self._step.state @ np.concatenate([velocity, position]) + self._step.load[:, 0] * loads[step]
            gap = self._gap(height, position)
            press = -h * presses[step] * self._normal[:, None]
            motion = np.vstack([free[2 * cells :], rate]) + self._inverse_masses * press
            normal, friction = self._impulses(motion, self._depth - gap)
            along, across = press + self._normal[:, None] * normal + self._tangent[:, None] * friction
            velocity = free[: 2 * cells] + self._step.response @ along
            position = position + h * velocity
            rate = rate + self._inverse_masses[1] * across
            height = height + h * rate
            rows[step] = np.concatenate([position, velocity, friction / h, normal / h, self._gap(height, position)])
        places, velocities, friction, normal, gaps = np.split(rows, np.array([2, 4, 5, 6]) * cells, axis=1)
        end = np.concatenate([gaps[-1], self._gap(rate, velocity)])
        return Trajectory(lane.times(start, steps), places, velocities, friction, normal, end, gaps)

    def _heights(self, state: State) -> tuple[FloatArray, FloatArray]:
        """Give places and velocities across the row, at which gaps and their rates are those of a state."""
        cells, (along, above) = self.lane.chain.cells, self._normal
        gaps = state.normal_state(cells)
        height, rate = (
            (gap[0] - along * (motion[0, cells:] - motion[0, :cells])) / above
            for gap, motion in zip(gaps, (state.positions, state.velocities), strict=True)
        )
        return height, rate

    def _gap(self, height: FloatArray, motion: FloatArray) -> FloatArray:
        """Give the gaps, or their rates."""
        cells, (along, above) = self.lane.chain.cells, self._normal
        gap: FloatArray = above * height + along * (motion[cells:] - motion[:cells])
        return gap

    def _impulses(self, motion: FloatArray, depth: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Give normal and friction impulses of contacts that would move so, along and across the row, without them.

        Normal impulses are solved without friction; μ times these bounds it, and then both are solved together.
        """
        chain, (n, t) = self.lane.chain, (self._normal, self._tangent)
        across, both, along = (a * b @ self._inverse_masses for a, b in ((n, n), (n, t), (t, t)))
        touching = (depth > 0) & (chain.friction_bound > 0)
        missing = self._erp / self.lane.time_step * np.maximum(depth - self._layer, 0.0) - n @ motion
        bound = np.where(touching, chain.friction_coefficient * np.maximum(missing / across, 0.0), 0.0)
        slip = t @ motion
        closed = np.clip(-(slip + both * missing / across) / (along - both**2 / across), -bound, bound)
        normal = (missing - both * closed) / across
        opened = np.clip(-slip / along, -bound, bound)
        presses = touching & (normal > 0)
        return np.where(presses, normal, 0.0), np.where(presses, closed, opened)
