"""What changed from one store to another: two versions of an engine, two sets of options, two machines."""

import json
import math
import sqlite3
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from engines.interface.tolerances import SCHEME_TOLERANCE_DB
from reference_lcp.observables.transition_matching import match_transitions
from reference_lcp.validation import ParameterError, checked_scalar
from scenarios.execution.store import ResultStore
from scenarios.tasks.result import Result
from scenarios.verdicts.finding import TRANSMITTANCE
from scenarios.verdicts.judge import metric_difference


@dataclass(frozen=True)
class Thresholds:
    """What counts as no change.

    Parameters
    ----------
    transmittance_db
        Largest difference of transmittance [dB] > 0, on the scale of `TRANSMITTANCE`; two engines that solve the same
        equations differ by less than the default.
    stuck_fraction
        Largest difference of a contact's stuck fraction, in (0, 1]; by default two steps of 400.
    transition
        Largest difference of the time of a transition, over the period, in (0, 1]; by default two steps of 400.

    Raises
    ------
    ParameterError
        If a threshold is outside its range.
    """

    transmittance_db: float = SCHEME_TOLERANCE_DB
    stuck_fraction: float = 0.005
    transition: float = 0.005

    def __post_init__(self) -> None:
        checked_scalar("threshold of transmittance", self.transmittance_db, "> 0")
        for name in ("stuck_fraction", "transition"):
            if not 0 < getattr(self, name) <= 1:
                raise ParameterError(f"threshold of {name} = {getattr(self, name)}; allowed: > 0 and <= 1")


@dataclass(frozen=True)
class Kept:
    """One answer of a store, with what it depends on.

    Parameters
    ----------
    question
        What was asked, as plain data: the same for every version and every options.
    version, options
        Of the engine that answered; options by name, as text.
    answer
        What came of it.
    """

    question: Mapping[str, Any]
    version: str
    options: Mapping[str, str]
    answer: Result

    @property
    def variant(self) -> str:
        """Engine, formulation and preset, joined by colons."""
        return ":".join(self.question["variant"][name] for name in ("engine", "formulation", "preset_name"))


@dataclass(frozen=True)
class Change:
    """One question that both stores answer.

    Parameters
    ----------
    first, second
        The answers.
    transmittance_db
        Second less first [dB]; NaN unless both have a steady state. So are the others.
    stuck_fraction
        Largest difference of a contact.
    transition
        Largest difference of the times of matched transitions, over the period; zero without any.
    unmatched
        Transitions of either that the other one does not have.
    beyond
        What passes its threshold, in words; empty where nothing does.
    """

    first: Kept
    second: Kept
    transmittance_db: float = math.nan
    stuck_fraction: float = math.nan
    transition: float = math.nan
    unmatched: int = 0
    beyond: tuple[str, ...] = ()


@dataclass(frozen=True)
class StoreComparison:
    """Everything that two stores have to say to each other.

    Parameters
    ----------
    changes
        Questions that both answer, in the order of the first store.
    only_first, only_second
        Number of questions that one of them answers, by variant.
    """

    changes: tuple[Change, ...]
    only_first: Mapping[str, int]
    only_second: Mapping[str, int]

    @property
    def beyond(self) -> list[Change]:
        """Changes that pass a threshold, the largest difference of transmittance first."""
        found = [change for change in self.changes if change.beyond]
        return sorted(
            found, key=lambda one: -math.inf if math.isnan(one.transmittance_db) else -abs(one.transmittance_db)
        )


def read_all(file: Path) -> dict[str, Kept]:
    """Give every answer of a store by what was asked, without version and options; of several the latest.

    Raises
    ------
    ParameterError
        If the file is missing, is no store, or is damaged.
    """
    if not file.is_file():
        raise ParameterError(f"store {file} does not exist; allowed: a store of answers")
    ResultStore(file).close()
    try:
        return dict(_rows(file))
    except (sqlite3.Error, KeyError, TypeError, ValueError) as problem:
        raise ParameterError(f"store {file} is damaged: {type(problem).__name__}: {problem}") from None


def _rows(file: Path) -> Iterator[tuple[str, Kept]]:
    with closing(sqlite3.connect(file)) as connection:
        for content, answer in connection.execute("SELECT content, answer FROM answers ORDER BY rowid"):
            asked = json.loads(content)
            kept = Kept(asked["task"], asked["version"], asked["options"], Result.from_json(answer))
            yield json.dumps(asked["task"], sort_keys=True), kept


def compare_stores(first: Path, second: Path, thresholds: Thresholds | None = None) -> StoreComparison:
    """Compare two stores, question by question.

    Raises
    ------
    ParameterError
        If one of them cannot be read.
    """
    a, b = read_all(first), read_all(second)
    limits = thresholds or Thresholds()
    return StoreComparison(
        changes=tuple(change(a[question], b[question], limits) for question in a if question in b),
        only_first=Counter(kept.variant for question, kept in a.items() if question not in b),
        only_second=Counter(kept.variant for question, kept in b.items() if question not in a),
    )


def change(first: Kept, second: Kept, thresholds: Thresholds) -> Change:
    """Compare two answers to the same question."""
    one, other = first.answer, second.answer
    if not (one.converged and other.converged):
        beyond = () if one.status == other.status else (f"{one.status} before, {other.status} now",)
        return Change(first, second, beyond=beyond)
    difference = metric_difference(TRANSMITTANCE, other.transmittance_db, one.transmittance_db)
    pairs = zip(other.stuck_fraction, one.stuck_fraction, strict=True)
    stuck = max((abs(new - old) for new, old in pairs), default=0.0)
    match = match_transitions(other.transitions, one.transitions, one.period)
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
