"""What is true of a steady state or a motion in a store: the exact motion, or the reference's with fine steps."""

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pydantic import TypeAdapter, ValidationError

from engines.interface.variant import Variant
from reference_lcp.refusal import ParameterError
from scenarios.tasks.result import Result, ResultStatus
from scenarios.tasks.task import SteadyStateTask
from scenarios.verdicts.pointwise import CONVERGED
from scenarios.verdicts.steady_case import EXACT, MOST_EXACT_CELLS, REFERENCE
from scenarios.verdicts.stored_results import StoredResult

NOT_OF_THE_CASE = ("variant", "steps_per_period", "start", "recorded", "time_step", "steps", "every")
"""What of a task says how its steady state or motion is found, and not which."""

FINER = 4
"""Steps of the reference over those of a motion, from which on its own is the truth where there is no exact one. It is
of first order: a quarter of the error is left, and scenarios of the catalogue compare with 4 to 16."""

KNOWN = (ResultStatus.CONVERGED, ResultStatus.FINISHED)
"""Results that say what is true."""

_TASK = TypeAdapter(SteadyStateTask)

Compute = Callable[[Sequence[SteadyStateTask]], Sequence[Result]]
"""Gives the results of tasks, in order."""


@dataclass(frozen=True)
class StoredTruth:
    """What is true of a case.

    Parameters
    ----------
    result
        A certified steady state, or a motion.
    source
        What it is, in words.
    """

    result: Result
    source: str


def truths_of(
    tasks: Iterable[Mapping[str, Any]], stored: Sequence[StoredResult], compute: Compute | None
) -> dict[str, StoredTruth]:
    """Give what is true of tasks, as plain data, where that is known.

    That is the exact motion, from a store or computed, and the converged one of a store where there is no exact one; of
    transient motions also the reference's with `FINER` steps.

    Parameters
    ----------
    tasks
        Whose truth is wanted; those that are neither steady states nor motions have none.
    stored
        Results in which it may be.
    compute
        Computes exact steady states of up to `MOST_EXACT_CELLS` cells; ``None`` where none is to be computed.

    Returns
    -------
    Truths by the text of their task, as `StoredResult.key` has it.
    """
    wanted = [task for task in tasks if "frequency_ratio" in task or _is_motion(task)]
    exact, converged, reference = (_finest(stored, variant) for variant in (EXACT, CONVERGED, REFERENCE))
    steady = {_case(task) for task in wanted if not _is_motion(task)}
    known = {case: StoredTruth(own.result, "converged reference") for case, own in converged.items()}
    known |= _computed(steady - exact.keys(), compute)
    known |= {case: StoredTruth(own.result, "exact motion") for case, own in exact.items()}
    truths = {json.dumps(task, sort_keys=True): known.get(_case(task)) or _finer(task, reference) for task in wanted}
    return {text: truth for text, truth in truths.items() if truth is not None}


def _is_motion(task: Mapping[str, Any]) -> bool:
    return "time_step" in task


def _case(task: Mapping[str, Any]) -> str:
    """Give what a task has in common with all that search for the same steady state, or give the same rows."""
    case = {name: value for name, value in task.items() if name not in NOT_OF_THE_CASE}
    if _is_motion(task):
        case |= {"recorded": task["recorded"], "rows": task["steps"] // task["every"]}
        case |= {"apart": f"{task['time_step'] * task['every']:.12g}"}  # refined steps are rounded
    return json.dumps(case, sort_keys=True)


def _finest(stored: Iterable[StoredResult], variant: Variant) -> dict[str, StoredResult]:
    """Give what a variant has by its cases, of several results the one with the most steps."""
    own = [each for each in stored if each.variant == str(variant) and each.result.status in KNOWN]
    return {_case(each.task): each for each in sorted(own, key=_steps)}


def _steps(stored: StoredResult) -> int:
    return int(stored.task["steps"]) if _is_motion(stored.task) else stored.result.steps_per_period


def _finer(task: Mapping[str, Any], reference: Mapping[str, StoredResult]) -> StoredTruth | None:
    """Give the motion of the reference, where it has so many more steps that it says what is true of a task."""
    best = reference.get(_case(task)) if _is_motion(task) else None
    if best is None or best.task["steps"] < FINER * task["steps"]:
        return None
    return StoredTruth(best.result, "reference with finer steps")


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
