"""What a store knows of the catalogue's scenarios: outcomes of every variant, and the numbers of scenes."""

from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from enum import StrEnum
from functools import partial
from typing import Any

import pandas as pd

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.base import Scenario, run_with_predictions
from multibody_xval.scenarios.catalogue.registry import CATALOGUE
from multibody_xval.scenarios.catalogue.scenes.base import SceneScenario
from multibody_xval.scenarios.catalogue.scenes.table import worst_numbers
from multibody_xval.scenarios.catalogue.verdict_table import finding_table
from multibody_xval.scenarios.runs.evaluator import Evaluator, StoredResults
from multibody_xval.scenarios.runs.executor import InProcessExecutor
from multibody_xval.scenarios.runs.result import Result, ResultStatus
from multibody_xval.scenarios.runs.store import ResultStore
from multibody_xval.scenarios.runs.task import Task
from multibody_xval.scenarios.verdicts.finding import Finding, Verdict


class Outcome(StrEnum):
    """Of one number; several have that of the worst, which comes first."""

    UNMODELLED = "unmodelled"
    MODELLED = "modelled"
    INCONCLUSIVE = "inconclusive"
    BLOCKED = "blocked"
    AGREES = "agrees"


SIGNS: Mapping[str, str] = {
    Outcome.UNMODELLED: "✗", Outcome.MODELLED: "≈", Outcome.INCONCLUSIVE: "?",
    Outcome.BLOCKED: "–", Outcome.AGREES: "✓",
}  # fmt: skip
"""What a cell shows beside its colour."""

Outcomes = Mapping[str, Mapping[Variant, Mapping[Outcome, int]]]
"""Numbers by outcome, by scenario and variant; what is not known is left out."""

_Run = Callable[[Sequence[Variant], Evaluator], list[Finding]]


def catalogue_outcomes(
    variants: Sequence[Variant], store: ResultStore, evaluator: Evaluator | None = None, run: Collection[str] = ()
) -> Outcomes:
    """Judge every scenario of which the store holds all results of a variant, and those of the others in it.

    Scenes have numbers instead: see `scene_numbers`.
    Scenarios that are to be `run` are evaluated by `evaluator` first; of all others nothing is computed.
    """
    stored = StoredResults(store)
    every = {
        name: _outcomes(scenario, variants, _Watched(store, evaluator if evaluator and name in run else stored))
        for name, scenario in CATALOGUE.items()
        if not isinstance(scenario, SceneScenario)
    }
    return {name: own for name, own in every.items() if own}


def scene_numbers(store: ResultStore) -> pd.DataFrame:
    """Give the worst number of each scene of which the store holds all results of a variant, of any engine.

    Columns ``engine``, ``number``, and ``default`` and ``recommended`` as `worst_numbers` gives them; nothing is run.
    """
    found: dict[Scenario, list[Finding]] = {}
    stored = StoredResults(store)
    for scenario in CATALOGUE.values():
        if isinstance(scenario, SceneScenario):
            watched = _Watched(store, stored)
            findings, whole = _whole(scenario, scenario.variants([]), watched, scenario.run)
            found[scenario] = [own for own in findings if own.variant in watched.known.intersection(whole)]
    if not any(found.values()):
        return pd.DataFrame()
    return worst_numbers(finding_table(found)).dropna(how="all").rename_axis(["engine", "number"]).reset_index()


def _outcomes(
    scenario: Scenario, variants: Sequence[Variant], watched: "_Watched"
) -> dict[Variant, Mapping[Outcome, int]]:
    """Give the outcomes of one scenario, the worst first; nothing where no variant is known in full.

    Without the results of its law nothing is known of a variant: whether it deviates as that says stays open.
    A variant that the scenario cannot be run with stands beside those that are known.
    """
    findings, whole = _whole(scenario, variants, watched, partial(run_with_predictions, scenario))
    shown = whole if watched.known.intersection(whole) else []
    return {variant: _counted([own for own in findings if own.variant == variant]) for variant in shown}


def _whole(
    scenario: Scenario, variants: Sequence[Variant], watched: "_Watched", run: _Run
) -> tuple[list[Finding], list[Variant]]:
    """Judge the variants of which nothing is missing, and give them; the others are left as soon as that is known."""
    while variants:
        watched.needed = {each for variant in variants for each in (variant, scenario.law_variant(variant)) if each}
        with suppress(_Missing):
            findings = run(variants, watched)
            return findings, _present(scenario, variants, watched)
        variants = _present(scenario, variants, watched)
    return [], []


def _present(scenario: Scenario, variants: Sequence[Variant], watched: "_Watched") -> list[Variant]:
    """Give the variants of which, and of whose laws, nothing is missing so far."""
    return [variant for variant in variants if not {variant, scenario.law_variant(variant)} & watched.missing]


class _Missing(Exception):
    """A result is missing of a variant that would be judged."""


class _Watched(Evaluator):
    """Results of an evaluator; notes of which variants some are known, and of which some are missing.

    Where it is asked about several variants at once, it ends the judging as soon as something is missing of those that
    are `needed`; of a store it then looks up one task each first.
    """

    def __init__(self, store: ResultStore, evaluator: Evaluator):
        super().__init__(store, InProcessExecutor())  # it gets no tasks
        self._evaluator = evaluator
        self.known: set[Variant] = set()
        self.missing: set[Variant] = set()
        self.needed: set[Variant] = set()

    def evaluate(self, tasks: Sequence[Task]) -> list[Result]:
        """Give the results, and note whose they are; what cannot be run is neither known nor missing."""
        first = {task.variant: task for task in tasks}
        if len(first) > 1 and isinstance(self._evaluator, StoredResults):
            self._noted(list(first.values()))
            self._leave_missing()
        results = self._noted(tasks)
        if len(first) > 1:
            self._leave_missing()
        return results

    def _leave_missing(self) -> None:
        if self.missing & self.needed:
            raise _Missing

    def _noted(self, tasks: Sequence[Task]) -> list[Result]:
        results = self._evaluator.evaluate(tasks)
        for task, result in zip(tasks, results, strict=True):
            if result.status is not ResultStatus.BLOCKED:
                (self.missing if result.status is ResultStatus.MISSING else self.known).add(task.variant)
        return results


def cell_of(counts: Mapping[Any, int]) -> dict[str, str]:
    """Give the class, the text and the words of a cell: the worst outcome, with how many have it where not all do."""
    worst = next(iter(counts))
    number = "" if len(counts) == 1 else f" {counts[worst]}"
    return {
        "outcome": str(worst).replace(" ", "-"),
        "text": SIGNS[worst] + number,
        "words": ", ".join(f"{count} {outcome}" for outcome, count in counts.items()),
    }


def _counted(findings: Sequence[Finding]) -> Mapping[Outcome, int]:
    counts = Counter(map(outcome, findings))
    return {each: counts[each] for each in Outcome if counts[each]}


def outcome(finding: Finding) -> Outcome:
    """Give one word for a finding."""
    match finding.comparison.verdict:
        case Verdict.AGREE:
            return Outcome.AGREES
        case Verdict.BLOCKED:
            return Outcome.BLOCKED
        case Verdict.DISAGREE:
            return Outcome.MODELLED if finding.modelled else Outcome.UNMODELLED
    return Outcome.INCONCLUSIVE
