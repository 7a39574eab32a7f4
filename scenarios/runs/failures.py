"""Failures are results: an engine that fails gives blocked results with the reason."""

import os
from collections import defaultdict
from collections.abc import Callable, Sequence
from typing import TypeVar

from multibody_xval.engines.interface.engine import EngineNotInstalled
from multibody_xval.scenarios.compute.batch import CIRCUMSTANCES
from multibody_xval.scenarios.compute.checked import NOT_FINITE, NotFinite, TrajectoryFault
from multibody_xval.scenarios.runs.result import NOT_INSTALLED, UNREPRESENTABLE, Result
from multibody_xval.scenarios.runs.task import Task
from reference_lcp.errors import ParameterError, RunError, text_of

UNSTEADY = "unsteady engine"
"""In reasons: a number is not finite, but it was when the same was run again."""

AnyTask = TypeVar("AnyTask", bound=Task)

WORKER_MARK = "MULTIBODY_XVAL_WORKER"
"""Variable of the environment that is set in worker processes."""


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
