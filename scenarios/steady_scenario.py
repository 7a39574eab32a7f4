"""Scenarios whose cases are steady states under a harmonic base motion."""

import math
from collections.abc import Mapping, Sequence
from typing import ClassVar

from engines.variant import Variant
from scenarios.agreement import Tolerance, compare
from scenarios.evaluation import Evaluator
from scenarios.questions import Answer, Question
from scenarios.scenario import Finding, Metric, Scenario
from scenarios.steady_case import (
    REFERENCE,
    Case,
    Evidence,
    Expected,
    amplitude_in_db,
    evidence,
    exact_expected,
    questions_of,
)
from scenarios.stick_slip_comparison import STICK_SLIP_METRICS, stick_slip_findings

TRANSMITTANCE = Metric("transmittance", "dB", "20 log10 of the last outer mass's fundamental amplitude over the base's")

SAME_STEP = Metric(
    "same step",
    "dB",
    "transmittance of presets that share the Euler scheme, against the reference with the same step: they solve the "
    "same equations, so that nothing is allowed but what neither can resolve",
)


class SteadyScenario(Scenario):
    """A scenario of steady states: subclasses say which, and what is expected of them."""

    cases: ClassVar[tuple[Case, ...]]
    """What is asked, the most telling case first."""

    with_stick_slip: ClassVar[bool] = False
    """Whether stick and slip are compared beside the transmittance."""

    metrics: ClassVar[tuple[Metric, ...]] = (TRANSMITTANCE, SAME_STEP)

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if cls.with_stick_slip:
            cls.metrics = (TRANSMITTANCE, SAME_STEP, *STICK_SLIP_METRICS)

    def expected(self, case: Case) -> Expected:
        """Give what the answer to a case should be; the exact motion unless overridden."""
        return exact_expected(case)

    def questions(self, variants: Sequence[Variant]) -> list[Question]:
        """Give everything that is asked: of each variant, and of the reference for the sake of the others."""
        asked = [q for variant in (REFERENCE, *variants) for case in self.cases for q in questions_of(variant, case)]
        return list(dict.fromkeys(asked))

    def run(self, variants: Sequence[Variant], evaluator: Evaluator) -> list[Finding]:
        """Put every case to every variant; see `Scenario.run`."""
        asked = self.questions(variants)
        answers = dict(zip(asked, evaluator.evaluate(asked), strict=True))
        expected = {case: self.expected(case) for case in self.cases}
        return [finding for variant in variants for finding in self.judged(variant, expected, answers)]

    def judged(
        self, variant: Variant, expected: Mapping[Case, Expected], answers: Mapping[Question, Answer]
    ) -> list[Finding]:
        """Judge the answers of one variant to all cases."""
        return [
            finding
            for case, right in expected.items()
            for finding in self.findings(evidence(variant, case, right, answers))
        ]

    def findings(self, found: Evidence) -> list[Finding]:
        """Judge one variant in one case."""
        findings = [transmittance_finding(found), *same_step_findings(found)]
        return [*findings, *stick_slip_findings(found)] if self.with_stick_slip else findings


def transmittance_finding(found: Evidence) -> Finding:
    """Compare the transmittance with what is expected."""
    value, expected = found.fine.transmittance_db, found.expected.transmittance_db
    missing = found.missing
    if missing is not None:
        return Finding(found.variant, found.case.label, TRANSMITTANCE, math.nan, expected, missing)
    comparison = compare(value, expected, found.transmittance_tolerance, TRANSMITTANCE.unit)
    return Finding(found.variant, found.case.label, TRANSMITTANCE, value, expected, comparison)


def same_step_findings(found: Evidence) -> list[Finding]:
    """Compare a preset that shares the scheme with the reference at equal step; nothing for the others."""
    if found.variant.engine == REFERENCE.engine or not found.variant.options.shares_scheme:
        return []
    value, expected = found.fine.transmittance_db, found.scheme[1].transmittance_db
    missing = found.missing
    if missing is None:
        resolution = amplitude_in_db(found.amplitude_resolution, expected)
        missing = compare(value, expected, Tolerance(0.0, 0.0, resolution), SAME_STEP.unit)
    return [Finding(found.variant, found.case.label, SAME_STEP, value, expected, missing)]
