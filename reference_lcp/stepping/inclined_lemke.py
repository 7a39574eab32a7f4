"""Chains with inclined contacts: equation (7) in full, by Lemke's method in every step, compiled.

`reference_lcp.lcp.inclined_chain` has the equations, and solves them as one system of all contacts.
"""

import math

import numpy as np

from reference_lcp.chain.preload import Preload
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.lcp.inclined_chain import InclinedChain
from reference_lcp.lcp.lemke import STATUSES
from reference_lcp.lcp.pivoting import SOLVED
from reference_lcp.lcp.scaling import power_of_two_scaling
from reference_lcp.lcp.time_step import PATHS, StepFailed, assemble
from reference_lcp.stepping.inclined_kernel import FIELDS, advance_inclined
from reference_lcp.stepping.sequential import LaneModel
from reference_lcp.validation import FloatArray

CONSTANT = Preload(modulation=0.0, angular_frequency=1.0)
"""A preload that does not change."""


class InclinedLane(LaneModel):
    """One chain whose normal forces depend on its motion; `State.normal_state` holds its gaps along the normals."""

    def __init__(self, lane: Lane):
        """Take a lane; one whose faces are along the row may be without a preload."""
        chain = lane.chain
        self.lane = lane
        self._sine, self._cosine = math.sin(lane.inclination), math.cos(lane.inclination)
        self._springs = np.array(
            [chain.chain_stiffness, chain.chain_damping, chain.inner_stiffness, chain.inner_damping]
        )
        self._masses = np.array([chain.outer_mass, chain.inner_mass])
        self._angle = np.array([[mu, self._sine, self._cosine] for mu in chain.friction_coefficient]).T.copy()
        self._matrices = _contact_matrices(lane)
        self._scales = np.array([power_of_two_scaling(matrix) for matrix in self._matrices])

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state`; see `LaneModel.run`."""
        n = self.lane.chain.cells
        gap, speed = state.normal_state(n)
        x = np.vstack(
            [self._with_heights(state.positions[0], gap[0]), self._with_heights(state.velocities[0], speed[0])]
        )
        record = np.empty((steps, FIELDS, n))
        solved, status = advance_inclined(
            x, self._springs, self._masses, self._matrices, self._scales, self._angle, self.lane.time_step,
            self.lane.loads(start, steps), np.ascontiguousarray(self.lane.preloads(start, steps)), PATHS, record,
        )  # fmt: skip
        if status != SOLVED:
            index = start + solved
            raise StepFailed(
                f"step {index} at t = {index * self.lane.time_step:.6g} s: the LCP of a contact is not solved: "
                f"{STATUSES[status]}"
            )
        gaps, speeds = self._normal(record[:, :3]), self._normal(record[-1:, 3:6])
        return Trajectory(
            time=self.lane.times(start, steps),
            positions=record[:, 0:2].reshape(steps, -1),
            velocities=record[:, 3:5].reshape(steps, -1),
            friction=record[:, 6].copy(),
            normal_force=record[:, 7].copy(),
            internal_state=np.concatenate([gaps[-1], speeds[-1]]),
            normal_gap=gaps,
        )

    def _with_heights(self, absolute: FloatArray, gap: FloatArray) -> FloatArray:
        """Give (u, v, y), shape (3, n), y being the coordinates at which the gaps are these; velocities likewise."""
        outer, inner = np.split(absolute, 2)
        return np.array([outer, inner, (gap + self._sine * (inner - outer)) / self._cosine])

    def _normal(self, coordinates: FloatArray) -> FloatArray:
        """Gaps from (u, v, y), shape (steps, 3, n); their rates from velocities."""
        outer, inner, across = coordinates.swapaxes(0, 1)
        gaps: FloatArray = self._cosine * across - self._sine * (inner - outer)
        return gaps


def _contact_matrices(lane: Lane) -> FloatArray:
    """Matrices of the LCPs of the contacts, shape (n, 3, 3), from that of equation (7), where no others are coupled."""
    n = lane.chain.cells
    system = InclinedChain(chain=lane.chain, drive=lane.drive, inclination=lane.inclination)
    matrix, _ = assemble(system.step(0.0, np.zeros(3 * n), np.zeros(3 * n), lane.time_step))
    return np.array([matrix[cell::n, cell::n] for cell in range(n)])
