"""What is true of a steady state in a store: the exact motion, or the reference's converged one."""

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pydantic import TypeAdapter, ValidationError

from engines.interface.variant import Variant
from reference_lcp.refusal import ParameterError
from scenarios.tasks.result import Result
from scenarios.tasks.task import SteadyStateTask
from scenarios.verdicts.pointwise import CONVERGED
from scenarios.verdicts.steady_case import EXACT, MOST_EXACT_CELLS
from scenarios.verdicts.stored_results import StoredResult

NOT_OF_THE_CASE = ("variant", "steps_per_period", "start", "recorded")
"""What of a task says how its steady state is found, and not which."""

_TASK = TypeAdapter(SteadyStateTask)

Compute = Callable[[Sequence[SteadyStateTask]], Sequence[Result]]
"""Gives the results of tasks, in order."""


@dataclass(frozen=True)
class StoredTruth:
    """What is true of a case.

    Parameters
    ----------
    result
        A certified steady state.
    source
        What it is, in words.
    """

    result: Result
    source: str


def truths_of(
    tasks: Iterable[Mapping[str, Any]], stored: Sequence[StoredResult], compute: Compute | None
) -> dict[str, StoredTruth]:
    """Give what is true of tasks, as plain data, where that is known.

    That is the exact motion, from a store or computed, and the converged motion of a store where there is no exact one.

    Parameters
    ----------
    tasks
        Whose truth is wanted; those that are no steady states have none.
    stored
        Results in which it may be.
    compute
        Computes exact motions of up to `MOST_EXACT_CELLS` cells; ``None`` where none is to be computed.

    Returns
    -------
    Truths by the text of their task, as `StoredResult.key` has it.
    """
    cases = {json.dumps(task, sort_keys=True): _case(task) for task in tasks if "frequency_ratio" in task}
    exact = _stored_truths(stored, EXACT, "exact motion")
    computed = _computed({case for case in cases.values() if case not in exact}, compute)
    known = {**_stored_truths(stored, CONVERGED, "converged reference"), **computed, **exact}
    return {text: known[case] for text, case in cases.items() if case in known}


def _case(task: Mapping[str, Any]) -> str:
    """Give what a task has in common with all that search for the same steady state."""
    return json.dumps({name: value for name, value in task.items() if name not in NOT_OF_THE_CASE}, sort_keys=True)


def _stored_truths(stored: Iterable[StoredResult], variant: Variant, source: str) -> dict[str, StoredTruth]:
    """Give the steady states of a variant by their cases, of several the one with the most steps."""
    own = [each for each in stored if each.variant == str(variant) and each.result.converged]
    own.sort(key=lambda each: each.result.steps_per_period)
    return {_case(each.task): StoredTruth(each.result, source) for each in own}


def _computed(cases: Iterable[str], compute: Compute | None) -> dict[str, StoredTruth]:
    """Compute the exact motion of cases; those that have none, or take long, are left out."""
    tasks = {case: task for case in sorted(cases) if (task := _exact_task(case)) is not None}
    if compute is None or not tasks:
        return {}
    results = dict(zip(tasks, compute(list(tasks.values())), strict=True))
    return {case: StoredTruth(result, "exact motion") for case, result in results.items() if result.converged}


def _exact_task(case: str) -> SteadyStateTask | None:
    """Give the task of the exact motion; ``None`` where the case cannot be read, or its chain is long."""
    try:
        task = _TASK.validate_python({**json.loads(case), "variant": EXACT})
    except (ValidationError, ParameterError):
        return None
    return task if task.ratios.cells <= MOST_EXACT_CELLS else None
