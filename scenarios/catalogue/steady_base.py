"""Scenarios whose cases are steady states under a harmonic base motion."""

import math
from collections.abc import Mapping, Sequence
from typing import ClassVar

from engines.interface.variant import Variant
from scenarios.catalogue.base import Scenario
from scenarios.execution.evaluator import Evaluator
from scenarios.tasks.result import Result, ResultStatus
from scenarios.tasks.task import SteadyStateTask
from scenarios.verdicts.finding import FLOOR_DB, TRANSMITTANCE, Finding, Metric
from scenarios.verdicts.judge import decide, judge
from scenarios.verdicts.steady_case import (
    EXACT,
    REFERENCE,
    Evidence,
    Expected,
    SteadyCase,
    evidence,
    exact_expected,
    questions_of,
)
from scenarios.verdicts.stick_slip_comparison import STICK_SLIP_METRICS, stick_slip_findings
from scenarios.verdicts.verdict import Comparison, Tolerance, Verdict

SAME_STEP = Metric(
    "same step",
    "dB",
    "transmittance of presets that share the Euler scheme, against the reference with the same step: they solve the "
    "same equations, so that nothing is allowed but what neither can resolve",
    FLOOR_DB,
)

LONGEST_SECONDS = 150.0
"""Seconds that a case may take an engine, both steps together; where an earlier case says that it takes longer, it is
not asked. The slowest of the presets that come close to Coulomb's law needs an eighth of it with seven cells."""


class SteadyScenario(Scenario):
    """A scenario of steady states: subclasses say which, and what is expected of them.

    The first case goes to every variant, the others to those that the first did not take too long.
    """

    cases: ClassVar[tuple[SteadyCase, ...]]
    """What is asked, the most telling case first."""

    with_stick_slip: ClassVar[bool] = False
    """Whether stick and slip are compared beside the transmittance."""

    metrics: ClassVar[tuple[Metric, ...]] = (TRANSMITTANCE, SAME_STEP)

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if cls.with_stick_slip:
            cls.metrics = (TRANSMITTANCE, SAME_STEP, *STICK_SLIP_METRICS)

    def expected(self, case: SteadyCase, answers: Mapping[SteadyStateTask, Result]) -> Expected:
        """Give what the answer to a case should be: the exact motion, unless overridden.

        `answers` holds those to `baseline`.
        """
        return exact_expected(answers[case.question(EXACT)])

    def stages(self) -> list[tuple[SteadyCase, ...]]:
        """Give the cases in the order in which they are asked; who is too slow in a round is not asked the next."""
        return [self.cases[:1], self.cases[1:]]

    def growth(self, case: SteadyCase) -> float:
        """Give by how much longer a case takes than the slowest of the round before."""
        return 1.0

    def baseline(self) -> list[SteadyStateTask]:
        """Give the tasks of the reference to which others are compared: its scheme, and the motion that is expected."""
        scheme = [question for case in self.cases for question in questions_of(REFERENCE, case)]
        return [*scheme, *(question for case in self.cases for question in self.expected_by(case))]

    def expected_by(self, case: SteadyCase) -> list[SteadyStateTask]:
        """Give the tasks from which `expected` is read: the exact motion, unless overridden."""
        return [case.question(EXACT)]

    def run(self, variants: Sequence[Variant], evaluator: Evaluator) -> list[Finding]:
        """Put every case to every variant; see `Scenario.run`."""
        answers = _answered(self.baseline(), evaluator)
        refused: dict[tuple[Variant, SteadyCase], Comparison] = {}
        before: tuple[SteadyCase, ...] = ()
        for cases in self.stages():
            for variant in variants:
                for case in cases:
                    reason = skip_reason(variant, before, self.growth(case), answers)
                    if reason is not None:
                        refused[variant, case] = reason
            places = [(variant, case) for variant in variants for case in cases if (variant, case) not in refused]
            answers |= _answered([q for variant, case in places for q in questions_of(variant, case)], evaluator)
            before = cases
        expected = {case: self.expected(case, answers) for case in self.cases}
        return [
            finding
            for variant in variants
            for finding in self.judged(
                {
                    case: evidence(variant, case, right, answers, refused.get((variant, case)))
                    for case, right in expected.items()
                }
            )
        ]

    def judged(self, found: Mapping[SteadyCase, Evidence]) -> list[Finding]:
        """Judge one variant in all cases."""
        return [finding for one in found.values() for finding in self.findings(one)]

    def findings(self, found: Evidence) -> list[Finding]:
        """Judge one variant in one case."""
        findings = [transmittance_finding(found), *same_step_findings(found)]
        return [*findings, *stick_slip_findings(found)] if self.with_stick_slip else findings


def _answered(questions: Sequence[SteadyStateTask], evaluator: Evaluator) -> dict[SteadyStateTask, Result]:
    """Answer questions, each once."""
    asked = list(dict.fromkeys(questions))
    return dict(zip(asked, evaluator.evaluate(asked), strict=True))


def skip_reason(
    variant: Variant, before: Sequence[SteadyCase], growth: float, answers: Mapping[SteadyStateTask, Result]
) -> Comparison | None:
    """Say why a variant is not asked, by the cases before; ``None`` if it is."""
    costs = []
    for case in before:
        own = [answers.get(question) for question in questions_of(variant, case)]
        known = [answer for answer in own if answer is not None]
        if len(known) < len(own):
            return Comparison(Verdict.INCONCLUSIVE, f"not asked, as it was not about {case.label}")
        if any(answer.status is ResultStatus.BLOCKED for answer in known):
            reason = next(answer.reason for answer in known if answer.status is ResultStatus.BLOCKED)
            return Comparison(Verdict.BLOCKED, f"not asked: blocked at {case.label}, {reason}")
        costs.append((sum(answer.seconds for answer in known if math.isfinite(answer.seconds)), case.label))
    seconds, label = max(costs, default=(0.0, ""))
    if growth * seconds <= LONGEST_SECONDS:
        return None
    reason = f"not asked: {label} took {seconds:.0f} s, this would take some {growth * seconds:.0f} s"
    return Comparison(Verdict.INCONCLUSIVE, f"{reason}, allowed {LONGEST_SECONDS:g} s")


def transmittance_finding(found: Evidence) -> Finding:
    """Compare the transmittance with what is expected."""
    expected = found.expected.transmittance_db
    if found.missing is not None:
        return Finding(found.variant, found.case.label, TRANSMITTANCE, math.nan, expected, found.missing)
    comparison = judge(
        TRANSMITTANCE,
        found.steps(lambda result: result.transmittance_db),
        expected,
        bar=found.expected.bar_db,
        scheme=found.scheme_steps(lambda result: result.transmittance_db),
        resolution=found.resolution_db(expected),
    )
    return Finding(found.variant, found.case.label, TRANSMITTANCE, found.fine.transmittance_db, expected, comparison)


def same_step_findings(found: Evidence) -> list[Finding]:
    """Compare a preset that shares the scheme with the reference at equal step; nothing for the others."""
    if found.variant.engine == REFERENCE.engine or not found.variant.preset.shares_scheme:
        return []
    value, expected = found.fine.transmittance_db, found.scheme[1].transmittance_db
    comparison = found.missing
    if comparison is None:
        comparison = decide(SAME_STEP, value, expected, Tolerance(resolution=found.resolution_db(expected)))
    return [Finding(found.variant, found.case.label, SAME_STEP, value, expected, comparison)]
