"""A simulation of an engine whose numbers are checked as it gives them."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.validation import FloatArray

TIME_MARGIN = 1e-3
"""Part of a step by which the time of a row may differ: a million steps that are added up one by one are off by at
most 1e12 roundings of half a step's last digit, 1e-4 of a step; a row of another step is off by a whole one."""

PRECISIONS = (np.dtype(np.float64), np.dtype(np.float32))
"""Types of the numbers that engines give."""


class TrajectoryFault(RuntimeError):
    """What an engine gives is no trajectory of its lane; the message names the array, the time and the cell."""


class CheckedSimulation:
    """A simulation that raises a `TrajectoryFault` where an engine gives what is no finite trajectory of its lane."""

    def __init__(self, simulation: Simulation):
        self.lanes = simulation.lanes
        self._simulation = simulation

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane, see `Simulation.run`."""
        runs = self._simulation.run(state, start, steps)
        for lane, run in zip(self.lanes, runs, strict=True):
            check_trajectory(run, lane, start, steps)
        return runs

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance every lane, and keep the final state; a number that is not finite is seen in the next run."""
        end = self._simulation.advance(state, start, steps)
        _check_type("position", end.positions)
        _check_type("velocity", end.velocities)
        return end

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> "CheckedSimulation":
        """Give a simulation of the lanes of these indices."""
        return CheckedSimulation(self._simulation.subset(lanes))

    def close(self) -> None:
        """Free what the engine holds."""
        self._simulation.close()


def check_trajectory(run: Trajectory, lane: Lane, start: int, steps: int) -> None:
    """Raise a `TrajectoryFault` unless `run` has the shapes and times of these steps, and is finite."""
    times, n = lane.times(start, steps), lane.chain.cells
    _check_array("position", run.positions, times, 2 * n, n)
    _check_array("velocity", run.velocities, times, 2 * n, n)
    _check_array("friction", run.friction, times, n, n)
    _check_array("normal force", run.normal_force, times, n, n)
    if run.normal_gap is not None:
        _check_array("normal gap", run.normal_gap, times, n, n)
    if run.internal_state is not None:
        _check_array("internal state", run.internal_state[None], times[-1:], run.internal_state.size, n)
    _check_times(run.time, times, lane.time_step)


def _check_array(name: str, values: FloatArray, times: FloatArray, columns: int, cells: int) -> None:
    """Refuse another shape than that of rows at these times [s], and numbers that are not finite."""
    _check_type(name, values)
    expected = (times.size, columns)
    if values.shape != expected:
        raise TrajectoryFault(f"the engine's {name} has the shape {values.shape}; allowed: {expected}")
    finite = np.isfinite(values)
    if not finite.all():
        row, column = np.argwhere(~finite)[0]
        place = f"at {times[row]:g} s in cell {int(column) % cells + 1}"
        raise TrajectoryFault(f"the engine's {name} is not finite {place}: {values[row, column]}")


def _check_type(name: str, values: FloatArray) -> None:
    """Refuse numbers that are complex, whole, or have fewer digits than single precision."""
    if values.dtype not in PRECISIONS:
        allowed = " or ".join(each.name for each in PRECISIONS)
        raise TrajectoryFault(f"the engine's {name} is of type {values.dtype}; allowed: {allowed}")


def _check_times(times: FloatArray, expected: FloatArray, step: float) -> None:
    """Refuse rows at other times than the ends of the steps [s]."""
    _check_type("time", times)
    if times.shape != expected.shape:
        raise TrajectoryFault(f"the engine's times have the shape {times.shape}; allowed: {expected.shape}")
    fits = np.abs(times - expected) <= TIME_MARGIN * step
    if not fits.all():
        row = int(np.argmin(fits))
        raise TrajectoryFault(f"the engine's time of row {row} is {times[row]:g} s; allowed: {expected[row]:g} s")
