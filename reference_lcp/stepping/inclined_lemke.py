"""Chains with inclined contacts: equation (7) in full, by Lemke's method in every step."""

import math

import numpy as np

from reference_lcp.chain.preload import Preload
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.lcp.frictional_system import simulate_system
from reference_lcp.lcp.inclined_chain import InclinedChain
from reference_lcp.stepping.sequential import LaneModel
from reference_lcp.validation import FloatArray

CONSTANT = Preload(modulation=0.0, angular_frequency=1.0)
"""A preload that does not change."""


class InclinedLane(LaneModel):
    """One chain whose normal forces depend on its motion; `State.normal_state` holds its gaps along the normals."""

    def __init__(self, lane: Lane):
        """Take a lane; one whose faces are along the row may be without a preload."""
        preload = lane.preload or CONSTANT
        self.lane = lane
        self._system = InclinedChain(
            chain=lane.chain,
            drive=lane.drive,
            inclination=lane.inclination,
            modulation=np.asarray(preload.modulation),
            modulation_frequency=preload.angular_frequency,
            modulation_phase=preload.phase,
        )

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state`; see `LaneModel.run`."""
        along = 2 * self.lane.chain.cells
        gap, speed = state.normal_state(self.lane.chain.cells)
        motion = simulate_system(
            self._system,
            position=self._with_heights(state.positions[0], gap[0]),
            velocity=self._with_heights(state.velocities[0], speed[0]),
            time_step=self.lane.time_step,
            steps=steps,
            start=start,
        )
        gaps, speeds = (each @ self._system.normal_directions for each in (motion.positions, motion.velocities[-1:]))
        return Trajectory(
            time=motion.time,
            positions=motion.positions[:, :along].copy(),
            velocities=motion.velocities[:, :along].copy(),
            friction=motion.friction,
            normal_force=motion.normal_force,
            internal_state=np.concatenate([gaps[-1], speeds[-1]]),
            normal_gap=gaps,
        )

    def _with_heights(self, absolute: FloatArray, gap: FloatArray) -> FloatArray:
        """Add the coordinates across the row, at which the gaps are these, to (u, v); velocities likewise."""
        outer, inner = np.split(absolute, 2)
        inclination = self.lane.inclination
        height = (gap + math.sin(inclination) * (inner - outer)) / math.cos(inclination)
        return np.concatenate([absolute, height])
