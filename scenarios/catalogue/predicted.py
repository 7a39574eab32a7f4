"""Scenarios run with their predictions: where a variant disagrees, its law is run as well."""

from collections.abc import Sequence

from engines.interface.variant import Variant
from scenarios.catalogue.base import Scenario
from scenarios.execution.evaluator import Evaluator
from scenarios.verdicts.finding import Finding
from scenarios.verdicts.prediction import needs_prediction, with_predictions


def run_with_predictions(scenario: Scenario, variants: Sequence[Variant], evaluator: Evaluator) -> list[Finding]:
    """Run a scenario, and the laws of variants that depart or say nothing somewhere; gives the findings in order."""
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
