"""The results of a store, each with what it depends on, and what is true of them: exact motions, or the reference's."""

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.parameters import first_error
from multibody_xval.scenarios.runs.result import Result, ResultStatus
from multibody_xval.scenarios.runs.store import ResultStore, existing_store
from multibody_xval.scenarios.runs.task import SteadyStateTask
from multibody_xval.scenarios.verdicts.proven import proven_level
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED, EXACT, MOST_EXACT_CELLS, REFERENCE
from reference_lcp.errors import ParameterError


@dataclass(frozen=True)
class _Content:
    """The part of a task's content that results are compared by, see `Task.content`."""

    format: int
    task: dict[str, Any]
    version: str
    options: dict[str, str]
    sources: str = ""


_CONTENT = TypeAdapter(_Content)


@dataclass(frozen=True)
class StoredResult:
    """One result of a store, with what it depends on."""

    task: Mapping[str, Any]
    """The task as plain data: the same for every version and every set of options."""
    format: int
    version: str
    options: Mapping[str, str]
    """Of the engine that ran it; options by name, as text."""
    result: Result
    sources: str = ""
    """Digest of the files of the suite that computed it; empty of stores of earlier versions."""

    @property
    def engine(self) -> str:
        """Name of its engine."""
        return str(self.task["variant"]["engine"])

    @property
    def variant(self) -> str:
        """Give its name, as everywhere."""
        return str(Variant(*(self.task["variant"][name] for name in ("engine", "formulation", "preset_name"))))

    def key(self) -> str:
        """Give the task as one text."""
        return json.dumps(self.task, sort_keys=True)


def read_all(file: Path) -> dict[str, StoredResult]:
    """Give every result of a store by its task, without version and options; of several the latest."""
    return {stored.key(): stored for stored in _rows(existing_store(file))}


def _rows(file: Path) -> Iterator[StoredResult]:
    with ResultStore(file) as store:
        for content, result in store.all_results():
            about = _read(file, content)
            yield StoredResult(about.task, about.format, about.version, about.options, result, about.sources)


def _read(file: Path, content: str) -> _Content:
    """Read what a row of a store is about."""
    try:
        return _CONTENT.validate_json(content)
    except ValidationError as problem:
        raise ParameterError(f"store {file}: {first_error(problem, 'format, task, version, options')}") from None


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
    """What is true of a case."""

    result: Result
    source: str


def truths_of(
    tasks: Iterable[Mapping[str, Any]], stored: Sequence[StoredResult], compute: Compute | None
) -> dict[str, StoredTruth]:
    """Give what is true of tasks, as plain data, where that is known, by the text of their task (`StoredResult.key`).

    That is the exact motion, from a store or computed, and the converged one of a store where there is no exact one,
    with level and phase as they are proven; of transient motions also the reference's with `FINER` steps.
    """
    wanted = [task for task in tasks if "frequency_ratio" in task or _is_motion(task)]
    exact, converged, reference = (_finest(stored, variant) for variant in (EXACT, CONVERGED, REFERENCE))
    steady = {_case(task) for task in wanted if not _is_motion(task)}
    known = {case: StoredTruth(own.result, "converged reference") for case, own in converged.items()}
    known |= _computed(steady - exact.keys(), compute)
    known |= {case: StoredTruth(own.result, "exact motion") for case, own in exact.items()}
    known |= {case: truth for case in steady if (truth := _proven(case, known.get(case))) is not None}
    truths = {json.dumps(task, sort_keys=True): known.get(_case(task)) or _finer(task, reference) for task in wanted}
    return {text: truth for text, truth in truths.items() if truth is not None}


def _proven(case: str, known: StoredTruth | None) -> StoredTruth | None:
    """Give the proven level and phase of a case, with what else is known of it; ``None`` where they are not proven."""
    task = _exact_task(case)
    level = None if task is None else proven_level(task)
    if level is None:
        return None
    result = Result(status=ResultStatus.CONVERGED) if known is None else known.result
    return StoredTruth(replace(result, **level.numbers), "proven" if known is None else f"proven level, {known.source}")


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
    steady = {case: task for case in sorted(cases) if (task := _exact_task(case)) is not None}
    tasks = {case: task for case, task in steady.items() if task.cells <= MOST_EXACT_CELLS}
    if compute is None or not tasks:
        return {}
    results = dict(zip(tasks, compute(list(tasks.values())), strict=True))
    return {case: StoredTruth(result, "exact motion") for case, result in results.items() if result.converged}


def _exact_task(case: str) -> SteadyStateTask | None:
    """Give the task of the exact motion; ``None`` where the case cannot be read."""
    try:
        return _TASK.validate_python({**json.loads(case), "variant": EXACT})
    except (ValidationError, ParameterError):
        return None
