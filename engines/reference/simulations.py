"""What the presets of the reference run: the exact motion, and the compiled scheme with finer Euler steps."""

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.exact.event_driven import EventDrivenSimulation
from reference_lcp.exact.event_driven_system import StickSlipLane
from reference_lcp.one_call import SteadyState, exact_steady_state
from reference_lcp.schemes.euler import euler_simulation
from reference_lcp.schemes.sequential import SequentialSimulation
from reference_lcp.validation import checked_count


class ExactSimulation(EventDrivenSimulation):
    """The event-driven simulation, whose steady states are polished by Newton's method and read from their events."""

    def steady_states(self, steps_per_period: int) -> list[SteadyState]:
        """Give the steady state of every lane; see `SteadyStateSolver`."""
        drives: list[Any] = [lane.drive for lane in self.lanes]  # periodic ones
        return [
            exact_steady_state(lane.chain, drive, steps_per_period=steps_per_period)
            for lane, drive in zip(self.lanes, drives, strict=True)
        ]


def exact_simulation(lanes: Sequence[Lane]) -> Simulation:
    """Give the event-driven motion; with static friction above kinetic friction, without steady states."""
    if any(lane.static_ratio > 1 for lane in lanes):
        return SequentialSimulation([StickSlipLane(lane) for lane in lanes])
    return ExactSimulation(lanes)


class RefinedSimulation:
    """The compiled scheme with a whole number of Euler steps to each time step of the lanes.

    Rows of trajectories are at their time steps; `fine` are the lanes with these Euler steps, where they are built.
    """

    def __init__(self, lanes: Sequence[Lane], substeps: int, fine: Simulation | None = None):
        self.lanes = tuple(lanes)
        self._substeps = checked_count("substeps", substeps)
        self._fine = fine or euler_simulation(
            [dataclasses.replace(lane, time_step=lane.time_step / substeps) for lane in self.lanes]
        )

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane, one at a time: fine trajectories of many lanes would fill the memory."""
        trajectories = []
        for lane in range(len(self.lanes)):
            fine = self._fine.subset([lane])
            every = fine.run(state.subset([lane]), start * self._substeps, steps * self._substeps)[0]
            trajectories.append(self._thinned(every, self.lanes[lane], start, steps))
        return trajectories

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance every lane, keep the final state; see `Simulation.advance`."""
        return self._fine.advance(state, start * self._substeps, steps * self._substeps)

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> "RefinedSimulation":
        """Give the lanes of these indices."""
        return RefinedSimulation([self.lanes[lane] for lane in lanes], self._substeps, self._fine.subset(lanes))

    def close(self) -> None:
        """Nothing is held outside Python."""

    def _thinned(self, fine: Trajectory, lane: Lane, start: int, steps: int) -> Trajectory:
        """Keep the last Euler step of each time step."""
        last = slice(self._substeps - 1, None, self._substeps)
        return Trajectory(
            lane.times(start, steps),
            fine.positions[last].copy(),
            fine.velocities[last].copy(),
            fine.friction[last].copy(),
            fine.normal_force[last].copy(),
            fine.internal_state,
            None if fine.normal_gap is None else fine.normal_gap[last].copy(),
        )
