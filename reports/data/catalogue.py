"""What a store knows of the catalogue's scenarios: the outcome of every variant in each; nothing is run."""

from collections import Counter
from collections.abc import Mapping, Sequence
from enum import StrEnum

from engines.interface.variant import Variant
from scenarios.catalogue import CATALOGUE
from scenarios.catalogue.base import Scenario
from scenarios.catalogue.predicted import run_with_predictions
from scenarios.execution.evaluator import StoredResults
from scenarios.execution.storage.store import ResultStore
from scenarios.tasks.result import Result, ResultStatus
from scenarios.tasks.task import Task
from scenarios.verdicts.finding import Finding
from scenarios.verdicts.verdict import Verdict


class Outcome(StrEnum):
    """Of one number; several have that of the worst, which comes first."""

    UNEXPLAINED = "unexplained"
    PREDICTED = "as predicted"
    UNDECIDED = "undecided"
    BLOCKED = "blocked"
    AGREES = "agrees"


Outcomes = Mapping[str, Mapping[Variant, Mapping[Outcome, int]]]
"""Numbers by outcome, by scenario and variant; what is not known is left out."""


def catalogue_outcomes(variants: Sequence[Variant], store: ResultStore) -> Outcomes:
    """Judge every scenario of which the store holds all results of a variant, and those of the others in it."""
    stored = _WatchedResults(store)
    every = {name: _outcomes(scenario, variants, stored) for name, scenario in CATALOGUE.items()}
    return {name: own for name, own in every.items() if own}


def _outcomes(
    scenario: Scenario, variants: Sequence[Variant], stored: "_WatchedResults"
) -> dict[Variant, Mapping[Outcome, int]]:
    """Give the outcomes of one scenario, the worst first; nothing where no variant is known in full.

    Without the results of its law nothing is known of a variant: whether it departs as predicted would be left open.
    A variant that the scenario cannot be run with stands beside those that are known.
    """
    stored.begin()
    findings = run_with_predictions(scenario, variants, stored)
    whole = [v for v in variants if not {v, scenario.law_variant(v)} & stored.missing]
    shown = whole if stored.known.intersection(whole) else []
    return {variant: _counted([own for own in findings if own.variant == variant]) for variant in shown}


class _WatchedResults(StoredResults):
    """Stored results; notes of which variants some are known, and of which some are missing."""

    def __init__(self, store: ResultStore):
        super().__init__(store)
        self.begin()

    def begin(self) -> None:
        """Forget what was noted."""
        self.known: set[Variant] = set()
        self.missing: set[Variant] = set()

    def evaluate(self, tasks: Sequence[Task]) -> list[Result]:
        """Give the results, and note whose they are; what cannot be run is neither known nor missing."""
        results = super().evaluate(tasks)
        for task, result in zip(tasks, results, strict=True):
            if result.status is not ResultStatus.BLOCKED:
                (self.missing if result.status is ResultStatus.MISSING else self.known).add(task.variant)
        return results


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
            return Outcome.PREDICTED if finding.as_predicted else Outcome.UNEXPLAINED
    return Outcome.UNDECIDED
