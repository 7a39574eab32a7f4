"""The base class of scenarios: a physical question whose answer is known, checked with every variant."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np

from engines.interface.registry import law_of
from engines.interface.tolerances import STEPS
from engines.interface.variant import Variant
from scenarios.runs.evaluator import Evaluator
from scenarios.runs.result import ResultStatus
from scenarios.runs.task import SteadyStateTask
from scenarios.runs.transient_task import TransientTask
from scenarios.verdicts.finding import Finding, Metric
from scenarios.verdicts.prediction import LawPeriod, needs_prediction, with_predictions


class Scenario(ABC):
    """A named experiment; the catalogue holds one object of each."""

    name: ClassVar[str]
    """As the command line knows it: lower case, hyphens."""
    question: ClassVar[str]
    """The physical question, in one sentence."""
    source: ClassVar[str]
    """Where the case is from: paper, equation, book."""
    expects: ClassVar[str]
    """What results are compared with: closed form, event-driven solution, reference with its error bar."""
    metrics: ClassVar[tuple[Metric, ...]]
    """What is compared."""

    def parameters(self) -> list[str]:
        """Give the parameters of the cases that their names leave out (numbers cell by cell, for example), in lines."""
        return []

    def law_variant(self, variant: Variant) -> Variant | None:
        """Give the variant that is the model of a variant's law in the cases of the scenario."""
        return variant.law

    def period_tasks(self, variant: Variant) -> Mapping[str, SteadyStateTask]:
        """Give, by case, the tasks that compare a period of a variant with its law's, from the same state."""
        return {}

    def law_periods(self, variant: Variant, evaluator: Evaluator) -> Mapping[str, LawPeriod]:
        """Compare, by case, a variant that has a law with it from the same state: over a period, unless overridden."""
        tasks = self.period_tasks(variant)
        results = evaluator.evaluate(list(tasks.values()))
        return {case: LawPeriod.of(task, result) for (case, task), result in zip(tasks.items(), results, strict=True)}

    @abstractmethod
    def run(self, variants: Sequence[Variant], evaluator: Evaluator) -> list[Finding]:
        """Run every case with every variant, and judge the results.

        Parameters
        ----------
        variants
            Variants to be compared. One that cannot be used gets findings with the verdict ``blocked`` and the reason.
        evaluator
            Runs the tasks; all that are known from the start go to it at once.

        Returns
        -------
        list of Finding
            One for every variant, case and metric, in this order.
        """


def run_with_predictions(scenario: Scenario, variants: Sequence[Variant], evaluator: Evaluator) -> list[Finding]:
    """Run a scenario, and the laws of variants that depart or say nothing somewhere; gives the findings in order."""
    evaluator.stage(scenario.name)
    findings = scenario.run(variants, evaluator)
    open_ones = dict.fromkeys(finding.variant for finding in findings if needs_prediction(finding))
    models = {variant: scenario.law_variant(variant) for variant in open_ones}
    laws = {variant: law for variant, law in models.items() if law is not None}
    predicted = scenario.run(list(laws.values()), evaluator) if laws else []
    judged: list[Finding] = []
    for variant in dict.fromkeys(finding.variant for finding in findings):
        own = [finding for finding in findings if finding.variant == variant]
        if variant in laws:
            of_law = [finding for finding in predicted if finding.variant == laws[variant]]
            own = with_predictions(own, of_law, scenario.law_periods(variant, evaluator))
        judged += own
    return judged


def motion_distance(task: TransientTask, of_law: TransientTask, series: str, evaluator: Evaluator) -> LawPeriod:
    """Give the largest difference of a series in the whole motion, or the reason why there is none.

    What a law allows of a period adds up over the motion at most. Motions are compared where the law does not claim to
    hold, too, for it may hold there; but not if it models other contacts than those of the task.
    """
    law = law_of(of_law.variant.preset)
    assert law is not None, "it is the model of a law"
    bound = law.period_bound * max(1.0, task.steps / STEPS)
    own, predicted = evaluator.evaluate([task, of_law])
    absent = (each.reason for each in (own, predicted) if each.status in (ResultStatus.BLOCKED, ResultStatus.MISSING))
    reason = law.other_contact_reason(task.lane()) or next(absent, None)
    if reason is not None:
        return LawPeriod(np.nan, bound, reason)
    motions = (np.array(result.series[series]) for result in (own, predicted))
    distance = float(np.max(np.abs(np.subtract(*motions))))
    return LawPeriod(distance, bound, law.unmodelled_reason(task.lane()) or "" if distance > bound else "")
