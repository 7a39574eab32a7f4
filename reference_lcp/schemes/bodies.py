"""The scheme of equation (5) for masses, springs and contacts that need not be a chain."""

from functools import lru_cache
from typing import cast

import numpy as np

from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.lcp.systems import MassSpringSystem, simulate_system
from reference_lcp.schemes.bodies_kernel import advance_bodies
from reference_lcp.schemes.sequential import LaneModel
from reference_lcp.validation import FloatArray


class EulerBodies(LaneModel):
    """One lane whose chain is a `MassSpringSystem`; where friction at rest is another, by Lemke's method."""

    def __init__(self, lane: Lane):
        self.lane, self.system = lane, cast(MassSpringSystem, lane.chain)
        self._given = lru_cache(maxsize=1)(self._read)

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state` at step index `start`."""
        system, (u,), (q,), dt = self.system, state.positions, state.velocities, self.lane.time_step
        if not system.one_coefficient:
            return simulate_system(system, position=u, velocity=q, time_step=dt, steps=steps, start=start)
        loads, normal, surfaces = self._given(start, steps)
        W, per_mass, f, c = system.directions, 1 / system.masses[:, None], system.freedoms, system.contacts
        matrices = per_mass * system.stiffness_matrix, per_mass * system.damping_matrix
        contacts = np.ascontiguousarray(W.T), per_mass * W, W.T @ (per_mass * W)
        bounds = dt * system.friction_coefficient * normal
        record = advance_bodies(u, q, (*matrices, *contacts), loads, bounds, surfaces, dt)
        return Trajectory(
            time=self.lane.times(start, steps), positions=record[:, :f], velocities=record[:, f : 2 * f],
            friction=record[:, 2 * f : 2 * f + c], normal_force=normal,
            slip=record[:, 2 * f + c :], friction_coefficient=system.friction_coefficient,
        )  # fmt: skip

    def _read(self, start: int, steps: int) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Loads over masses and normal forces at the start of each step, and speeds of the ground at its end."""
        times, shape = self.lane.times(start - 1, steps).tolist(), (steps, self.system.contacts)
        loads = np.zeros((steps, self.system.freedoms))
        for body, signal in self.system.loads:
            loads[:, body] += [signal.value(time) / self.system.masses[body] for time in times]
        normal = [[signal.value(time) for signal in self.system.normal_signals] for time in times]
        surfaces = [[own.value(time + self.lane.time_step) for own in self.system.surface_speeds] for time in times]
        return loads, np.reshape(normal, shape), np.reshape(surfaces, shape)
