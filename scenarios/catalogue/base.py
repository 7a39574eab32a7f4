"""The base class of scenarios: a physical question whose answer is known, checked with every variant."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import ClassVar

from multibody_xval.engines.interface.variant import EVERY_VARIANT, Variant, variants_named
from multibody_xval.scenarios.catalogue.descriptions import DESCRIPTIONS
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.task import SteadyStateTask
from multibody_xval.scenarios.verdicts.finding import Finding, Metric
from multibody_xval.scenarios.verdicts.prediction import LawPeriod, needs_prediction, with_predictions


class Scenario(ABC):
    """A named experiment; the catalogue holds one object of each."""

    name: ClassVar[str]
    """As the command line knows it: lower case, hyphens; one of `DESCRIPTIONS`."""
    source: ClassVar[str]
    """Where the case is from: paper, equation, book."""
    metrics: ClassVar[tuple[Metric, ...]]
    """What is compared."""

    @property
    def question(self) -> str:
        """The physical question, in one sentence."""
        return DESCRIPTIONS[self.name].question

    @property
    def expects(self) -> str:
        """What results are compared with: closed form, event-driven solution, reference with its error bar."""
        return DESCRIPTIONS[self.name].expects

    def parameters(self) -> list[str]:
        """Give the parameters of the cases that their names leave out (numbers cell by cell, for example), in lines."""
        return []

    def variants(self, names: Sequence[str]) -> list[Variant]:
        """Give the variants of these names, those of every engine without any; see `variants_named`."""
        return variants_named(names or [EVERY_VARIANT])

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
    """Run a scenario, and the laws of variants that deviate or say nothing somewhere; gives the findings in order."""
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
