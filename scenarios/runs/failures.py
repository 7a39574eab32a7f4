"""Failures are results: an engine that fails gives blocked results with the reason."""

import os
from collections import defaultdict
from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from multibody_xval.engines.interface.engine import EngineNotInstalled
from multibody_xval.scenarios.runs.result import NOT_INSTALLED, UNREPRESENTABLE, Result
from multibody_xval.scenarios.runs.task import Task
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.errors import ParameterError, RunError, text_of
from reference_lcp.validation import FloatArray

TIME_MARGIN = 1e-3
"""Part of a step by which the time of a row may differ: a million steps that are added up one by one are off by at
most 1e12 roundings of half a step's last digit, 1e-4 of a step; a row of another step is off by a whole one."""


PRECISIONS = (np.dtype(np.float64), np.dtype(np.float32))
"""Types of the numbers that engines give."""


class TrajectoryFault(RuntimeError):
    """What an engine gives is no trajectory of its lane; the message names the array, the time and the cell."""


class NotFinite(TrajectoryFault):
    """A number of the engine is not finite."""


NOT_FINITE, UNSTEADY = "not finite", "unsteady engine"
"""In reasons: a number is NaN or infinite; and it was, but not when the same was run again."""


class CheckedSimulation:
    """A simulation of an engine, whose trajectories are checked as it gives them."""

    def __init__(self, simulation: Simulation):
        self.lanes = simulation.lanes
        self._simulation = simulation

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane, see `Simulation.run`, or raise a `TrajectoryFault`."""
        runs = self._simulation.run(state, start, steps)
        for lane, run in zip(self.lanes, runs, strict=True):
            check_trajectory(run, lane, start, steps)
        return runs

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance every lane, keep the final state, from which nothing but the next run begins."""
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
        raise NotFinite(f"the engine's {name} is {NOT_FINITE} {place}: {values[row, column]}")


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


AnyTask = TypeVar("AnyTask", bound=Task)

WORKER_MARK = "MULTIBODY_XVAL_WORKER"
"""Variable of the environment that is set in worker processes."""

CIRCUMSTANCES = (MemoryError, OSError)
"""Errors that say more of the machine than of the engine: too little memory, too many open files, a full disk."""


class ExecutorError(RunError):
    """Nothing can be run any more: no process can be started, or no worker of a cluster is left."""


def results_together(
    tasks: Sequence[AnyTask], alike: Callable[[AnyTask], object], attempt: Callable[[Sequence[AnyTask]], list[Result]]
) -> list[Result]:
    """Run tasks, those that are alike at once; gives their results in order. What cannot be represented is blocked."""
    results: dict[int, Result] = {}
    groups: dict[object, list[int]] = defaultdict(list)
    for number, task in enumerate(tasks):
        try:
            groups[alike(task)].append(number)
        except ParameterError as problem:
            results[number] = Result.blocked(reason_of(problem))
    for numbers in groups.values():
        results |= zip(numbers, _attempted([tasks[number] for number in numbers], attempt), strict=True)
        results |= {number: _repeated(tasks[number], results[number], attempt) for number in numbers}
    return [results[number] for number in range(len(tasks))]


def _attempted(tasks: Sequence[AnyTask], attempt: Callable[[Sequence[AnyTask]], list[Result]]) -> list[Result]:
    """Run tasks at once; if that fails, one by one; one that fails alone is blocked.

    Whatever an engine raises is its result, an end of the program (`SystemExit`) too. An interrupt is the user's in
    the process that the user has started, and the engine's in a worker, which no interrupt from outside reaches.
    """
    try:
        return attempt(tasks)
    except EngineNotInstalled as problem:
        return [Result.blocked(f"{NOT_INSTALLED}: {text_of(problem)}")] * len(tasks)
    except BaseException as problem:
        if isinstance(problem, KeyboardInterrupt) and WORKER_MARK not in os.environ:
            raise
        if len(tasks) > 1:
            alone = [_attempted([task], attempt)[0] for task in tasks]
            steady = not isinstance(problem, NotFinite) or any(_is_not_finite(result) for result in alone)
            return alone if steady else [_unsteady(reason_of(problem))] * len(tasks)
        return [Result.blocked(reason_of(problem), by_engine=not isinstance(problem, CIRCUMSTANCES))]


def _repeated(task: AnyTask, result: Result, attempt: Callable[[Sequence[AnyTask]], list[Result]]) -> Result:
    """Run a task once more whose numbers are not finite: an engine that then gives something else is unsteady."""
    if not _is_not_finite(result) or _attempted([task], attempt)[0].reason == result.reason:
        return result
    return _unsteady(result.reason)


def _is_not_finite(result: Result) -> bool:
    return result.by_engine and NOT_FINITE in result.reason


def _unsteady(reason: str) -> Result:
    return Result.blocked(f"{UNSTEADY}: {reason}; not so when run again", by_engine=True)


def reason_of(problem: BaseException) -> str:
    """Give the reason that an exception is."""
    if isinstance(problem, TrajectoryFault):
        return str(problem)
    kind = UNREPRESENTABLE if isinstance(problem, ParameterError) else type(problem).__name__
    return f"{kind}: {text_of(problem)}"
