"""Changes from one store to another: two versions of an engine, two sets of options, two machines."""

import json
import math
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import TypeAdapter, ValidationError

from reference_lcp.observables.transition_matching import match_transitions
from reference_lcp.refusal import ParameterError
from reference_lcp.validation import FloatArray
from scenarios.execution.store import ResultStore
from scenarios.execution.store_file import existing_store
from scenarios.tasks.result import Result, ResultStatus
from scenarios.tasks.validation_message import first_error
from scenarios.verdicts.finding import TRANSMITTANCE
from scenarios.verdicts.judge import metric_difference
from scenarios.verdicts.thresholds import Thresholds

NUMBERS = ("transmittance_db", "residual", "period", "stuck_fraction", "creep", "open_fraction", "largest_gap")
"""Numbers of a result, one or one a contact, that do not depend on how it was found."""

TRANSITION_TIME = "time of a transition"
"""Beside them; a transition that is gone is one without a partner."""


@dataclass(frozen=True)
class _Content:
    """The part of a task's content that results are compared by, see `Task.content`."""

    format: int
    task: dict[str, Any]
    version: str
    options: dict[str, str]


_CONTENT = TypeAdapter(_Content)


@dataclass(frozen=True)
class StoredResult:
    """One result of a store, with what it depends on.

    Parameters
    ----------
    task
        The task as plain data: the same for every version and every set of options.
    format
        Format of the result: what its numbers mean.
    version, options
        Of the engine that ran it; options by name, as text.
    result
        Its result.
    """

    task: Mapping[str, Any]
    format: int
    version: str
    options: Mapping[str, str]
    result: Result

    @property
    def variant(self) -> str:
        """Engine, formulation and preset, joined by colons."""
        return ":".join(self.task["variant"][name] for name in ("engine", "formulation", "preset_name"))


@dataclass(frozen=True)
class Change:
    """One task of the first store.

    Parameters
    ----------
    first, second
        The results; a lost one is ``missing``.
    transmittance_db
        Second less first [dB]; NaN unless both have a steady state. So are the others.
    stuck_fraction
        Largest difference of a contact.
    transition
        Largest difference of the times of matched transitions, over the period; zero without any.
    unmatched
        Transitions of either that the other one does not have.
    beyond
        Changes that pass a threshold, in words; empty where nothing does.
    """

    first: StoredResult
    second: StoredResult
    transmittance_db: float = math.nan
    stuck_fraction: float = math.nan
    transition: float = math.nan
    unmatched: int = 0
    beyond: tuple[str, ...] = ()


@dataclass(frozen=True)
class StoreComparison:
    """The differences of two stores.

    Parameters
    ----------
    changes
        Tasks whose results both hold, and those that the second store has lost, in the order of the first.
    only_first, only_second
        Number of tasks whose results only this one holds, by variant.
    """

    changes: tuple[Change, ...]
    only_first: Mapping[str, int]
    only_second: Mapping[str, int]

    @property
    def common(self) -> list[Change]:
        """Tasks whose results both stores hold."""
        return [change for change in self.changes if change.second.result.status is not ResultStatus.MISSING]

    @property
    def beyond(self) -> list[Change]:
        """Changes that pass a threshold, the largest difference of transmittance first."""
        beyond = [change for change in self.changes if change.beyond]
        return sorted(
            beyond,
            key=lambda change: -math.inf if math.isnan(change.transmittance_db) else -abs(change.transmittance_db),
        )


def read_all(file: Path) -> dict[str, StoredResult]:
    """Give every result of a store by its task, without version and options; of several the latest.

    Raises
    ------
    ParameterError
        If the file is missing, is no store, or is damaged.
    """
    return dict(_rows(existing_store(file)))


def _rows(file: Path) -> Iterator[tuple[str, StoredResult]]:
    with ResultStore(file) as store:
        store.check_pages()
        for content, result in store.all_results():
            about = _read(file, content)
            stored = StoredResult(about.task, about.format, about.version, about.options, result)
            yield json.dumps(stored.task, sort_keys=True), stored


def _read(file: Path, content: str) -> _Content:
    """Read what a row of a store is about."""
    try:
        return _CONTENT.validate_json(content)
    except ValidationError as problem:
        raise ParameterError(f"store {file}: {first_error(problem, 'format, task, version, options')}") from None


def compare_stores(first: Path, second: Path, thresholds: Thresholds | None = None) -> StoreComparison:
    """Compare two stores, task by task.

    Raises
    ------
    ParameterError
        If one of them cannot be read, or they hold the same task in different formats.
    """
    a, b = read_all(first), read_all(second)
    for task in a.keys() & b.keys():
        if a[task].format != b[task].format:
            formats = f"{first} has results of format {a[task].format}, {second} of format {b[task].format}"
            raise ParameterError(f"{formats}: their numbers mean different things; allowed: stores of one format")
    limits = thresholds or Thresholds()
    return StoreComparison(
        changes=tuple(change(a[task], b.get(task) or _lost(a[task]), limits) for task in a),
        only_first=Counter(stored.variant for task, stored in a.items() if task not in b),
        only_second=Counter(stored.variant for task, stored in b.items() if task not in a),
    )


def _lost(stored: StoredResult) -> StoredResult:
    """Give what the second store has of a task that it does not know."""
    return replace(stored, result=Result.missing())


def change(first: StoredResult, second: StoredResult, thresholds: Thresholds) -> Change:
    """Compare two results of the same task; a blocked one has nothing to lose."""
    old, new = first.result, second.result
    if old.status is ResultStatus.BLOCKED:
        return Change(first, second)
    if new.status != old.status:
        reason = f": {new.reason}" if new.status is ResultStatus.BLOCKED else ""
        return Change(first, second, beyond=(f"{old.status} before, {new.status} now{reason}",))
    lost = _lost_numbers(old, new)
    if lost or not old.converged:
        return Change(first, second, beyond=lost)
    return _changed_numbers(first, second, thresholds)


def _lost_numbers(old: Result, new: Result) -> tuple[str, ...]:
    """Say which numbers are no longer there, or no longer finite."""
    lost = []
    after = _numbers(new)
    for name, before in _numbers(old).items():
        now = after.get(name, np.empty(0))
        if np.sum(~np.isfinite(now)) > np.sum(~np.isfinite(before)):
            lost.append(f"{name.replace('_', ' ')} is no longer finite")
        elif len(now) == 0 < len(before) and name != TRANSITION_TIME:
            lost.append(f"{name.replace('_', ' ')} is no longer complete")
    return tuple(lost)


def _numbers(result: Result) -> dict[str, FloatArray]:
    """Give `NUMBERS`, the times of all transitions and the series of a result, as arrays by name."""
    named = {name: np.atleast_1d(getattr(result, name)) for name in NUMBERS}
    times = np.array([time for _, time, _ in result.transitions])
    return {**named, TRANSITION_TIME: times, **{name: np.array(values) for name, values in result.series.items()}}


def _changed_numbers(first: StoredResult, second: StoredResult, thresholds: Thresholds) -> Change:
    """Compare two steady states."""
    old, new = first.result, second.result
    difference = metric_difference(TRANSMITTANCE, new.transmittance_db, old.transmittance_db)
    pairs = zip(new.stuck_fraction, old.stuck_fraction, strict=True)
    stuck = max((abs(after - before) for after, before in pairs), default=0.0)
    match = match_transitions(new.transitions, old.transitions, old.period)
    late = max((abs(error) for error in match.time_errors), default=0.0)
    unmatched = len(match.missed) + len(match.spurious)
    passed = {
        f"transmittance {difference:+.4g} dB": abs(difference) > thresholds.transmittance_db,
        f"stuck fraction {stuck:.3g}": stuck > thresholds.stuck_fraction,
        f"a transition {100 * late:.2g} % of the period away": late > thresholds.transition,
        f"{unmatched} transitions without a partner": unmatched > 0,
    }
    return Change(
        first, second, difference, stuck, late, unmatched, tuple(text for text, is_so in passed.items() if is_so)
    )
