"""Failures are results: an engine that cannot answer gives blocked answers with the reason."""

from collections.abc import Callable, Sequence
from typing import TypeVar

from engines.interface.engine import EngineNotInstalled
from reference_lcp.validation import ParameterError
from scenarios.tasks.result import Result

Item = TypeVar("Item")


def answered_together(items: Sequence[Item], attempt: Callable[[Sequence[Item]], list[Result]]) -> list[Result]:
    """Answer items at once; if that fails, one by one; who fails alone is blocked.

    Parameters
    ----------
    items
        What is asked.
    attempt
        Answers them all, or raises.

    Returns
    -------
    list of Result
        In the order of the items.
    """
    try:
        return attempt(items)
    except EngineNotInstalled as problem:
        return [Result.blocked(str(problem))] * len(items)
    except Exception as problem:
        if len(items) > 1:
            return [answered_together([item], attempt)[0] for item in items]
        kind = "cannot be represented" if isinstance(problem, ParameterError) else type(problem).__name__
        return [Result.blocked(f"{kind}: {problem}")]
