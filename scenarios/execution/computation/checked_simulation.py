"""What an engine gives is checked before anything is read from it: arrays, numbers, times."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.validation import FloatArray

TIME_MARGIN = 1e-3
"""Part of a step by which the time of a row may differ: a million steps that are added up one by one are off by at
most 1e12 roundings of half a step's last digit, 1e-4 of a step; a row of another step is off by a whole one."""


class TrajectoryFault(RuntimeError):
    """What an engine gives is no trajectory of its lane; the message names the array, the time and the cell."""


class CheckedSimulation:
    """A simulation of an engine, whose trajectories are checked as it gives them.

    Parameters
    ----------
    simulation
        As the engine has built it.
    """

    def __init__(self, simulation: Simulation):
        self.lanes = simulation.lanes
        self._simulation = simulation

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane; see `Simulation.run`.

        Raises
        ------
        TrajectoryFault
            If a trajectory is none; see `check_trajectory`.
        """
        runs = self._simulation.run(state, start, steps)
        for lane, run in zip(self.lanes, runs, strict=True):
            check_trajectory(run, lane, start, steps)
        return runs

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance every lane, keep the final state, from which nothing but the next run begins."""
        return self._simulation.advance(state, start, steps)

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> "CheckedSimulation":
        """Give a simulation of the lanes of these indices."""
        return CheckedSimulation(self._simulation.subset(lanes))

    def close(self) -> None:
        """Free what the engine holds."""
        self._simulation.close()


def check_trajectory(run: Trajectory, lane: Lane, start: int, steps: int) -> None:
    """Refuse what is no trajectory of a lane.

    Parameters
    ----------
    run
        What an engine gives for `steps` steps from step index `start`.
    lane
        What it was given.

    Raises
    ------
    TrajectoryFault
        If an array has another shape or a number that is not finite, or rows have other times than the lane's steps.
    """
    times, n = lane.times(start, steps), lane.chain.cells
    arrays = [
        _Array("position", run.positions, times, 2 * n, n),
        _Array("velocity", run.velocities, times, 2 * n, n),
        _Array("friction", run.friction, times, n, n),
        _Array("normal force", run.normal_force, times, n, n),
    ]
    if run.normal_gap is not None:
        arrays.append(_Array("normal gap", run.normal_gap, times, n, n))
    if run.internal_state is not None:
        arrays.append(_Array("internal state", run.internal_state[None], times[-1:], run.internal_state.size, n))
    for array in arrays:
        array.check_finite()
    _check_times(run.time, times, lane.time_step)


@dataclass(frozen=True)
class _Array:
    """An array of a trajectory, with the times of its rows [s], its number of columns, and the number of cells."""

    name: str
    values: FloatArray
    times: FloatArray
    columns: int
    cells: int

    def check_finite(self) -> None:
        """Refuse another shape, and numbers that are not finite."""
        expected = (self.times.size, self.columns)
        if self.values.shape != expected:
            raise TrajectoryFault(f"the engine's {self.name} has the shape {self.values.shape}; allowed: {expected}")
        finite = np.isfinite(self.values)
        if not finite.all():
            row, column = np.argwhere(~finite)[0]
            value, place = self.values[row, column], _place(self.times[row], int(column) % self.cells)
            raise TrajectoryFault(f"the engine's {self.name} is not finite {place}: {value}")


def _check_times(times: FloatArray, expected: FloatArray, step: float) -> None:
    """Refuse rows at other times than the ends of the steps [s]."""
    if times.shape != expected.shape:
        raise TrajectoryFault(f"the engine's times have the shape {times.shape}; allowed: {expected.shape}")
    fits = np.abs(times - expected) <= TIME_MARGIN * step
    if not fits.all():
        row = int(np.argmin(fits))
        raise TrajectoryFault(f"the engine's time of row {row} is {times[row]:g} s; allowed: {expected[row]:g} s")


def _place(time: float, cell: int) -> str:
    return f"at {time:g} s in cell {cell + 1}"
