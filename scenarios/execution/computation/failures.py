"""Failures are results: an engine that fails gives blocked results with the reason."""

import os
from collections.abc import Callable, Sequence
from typing import TypeVar

from engines.interface.engine import EngineNotInstalled
from reference_lcp.refusal import ParameterError, RunError
from scenarios.execution.computation.checked_simulation import TrajectoryFault
from scenarios.tasks.result import Result

Item = TypeVar("Item")

CIRCUMSTANCES = (MemoryError, OSError)
"""Errors that say more of the machine than of the engine: too little memory, too many open files, a full disk."""


class ExecutorError(RunError):
    """Nothing can be run any more: no process can be started, or no worker of a cluster is left."""


def results_together(items: Sequence[Item], attempt: Callable[[Sequence[Item]], list[Result]]) -> list[Result]:
    """Run items at once; if that fails, one by one; one that fails alone is blocked.

    Whatever an engine raises is its result, an end of the program (`SystemExit`) too. An interrupt is the user's in
    the process that the user has started, and the engine's in a worker, which no interrupt from outside reaches.

    Parameters
    ----------
    items
        What is run.
    attempt
        Runs them all, or raises.

    Returns
    -------
    list of Result
        In the order of the items.
    """
    try:
        return attempt(items)
    except EngineNotInstalled as problem:
        return [Result.blocked(text_of(problem))] * len(items)
    except BaseException as problem:
        if isinstance(problem, KeyboardInterrupt) and not in_worker():
            raise
        if len(items) > 1:
            return [results_together([item], attempt)[0] for item in items]
        return [Result.blocked(reason_of(problem), by_engine=not isinstance(problem, CIRCUMSTANCES))]


def reason_of(problem: BaseException) -> str:
    """Give the reason that an exception is."""
    if isinstance(problem, TrajectoryFault):
        return str(problem)
    kind = "cannot be represented" if isinstance(problem, ParameterError) else type(problem).__name__
    return f"{kind}: {text_of(problem)}"


def text_of(problem: BaseException) -> str:
    """Give the message of an exception, also of one whose own ``__str__`` fails."""
    try:
        return str(problem)
    except BaseException as failure:  # an engine's own class
        return f"its message cannot be read ({type(failure).__name__})"


WORKER_MARK = "MULTIBODY_XVAL_WORKER"
"""Variable of the environment that is set in worker processes."""


def in_worker() -> bool:
    """Whether this is a worker process."""
    return WORKER_MARK in os.environ
