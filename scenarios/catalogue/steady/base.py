"""Scenarios whose cases are steady states under a harmonic base motion."""

import cmath
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import ClassVar

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.base import Scenario
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.parameters import ChainRatios, Ratio
from multibody_xval.scenarios.runs.result import Result, ResultStatus
from multibody_xval.scenarios.runs.task import Recorded, SteadyStateTask
from multibody_xval.scenarios.verdicts.finding import (
    FLOOR_DB,
    PHASE,
    TRANSMITTANCE,
    Comparison,
    Finding,
    Metric,
    Tolerance,
    Verdict,
)
from multibody_xval.scenarios.verdicts.judge import decide, judge, of_amplitude, of_response, response_readers
from multibody_xval.scenarios.verdicts.proven import proven_level
from multibody_xval.scenarios.verdicts.steady_case import (
    EXACT,
    REFERENCE,
    Evidence,
    Expected,
    SteadyCase,
    case_tasks,
    collect_evidence,
    exact_expected,
    third_task,
)
from multibody_xval.scenarios.verdicts.stick_slip_comparison import STICK_SLIP_METRICS, stick_slip_findings
from reference_lcp.steady.richardson import amplitude_in_db

SAME_STEP = Metric(
    "same step",
    "dB",
    "complex transmittance of presets that share the Euler scheme, against the reference with the same step: they "
    "solve the same equations, so that nothing is allowed but what neither can resolve; a difference of phase counts "
    "as one of amplitude",
    FLOOR_DB,
)

LONGEST_SECONDS = 150.0
"""Seconds that a case may take an engine, both steps together; where an earlier case shows that it takes longer, it is
skipped. The slowest of the presets that come close to Coulomb's law needs an eighth of it with seven cells."""


_Results = dict[SteadyStateTask, Result]
_Skipped = dict[tuple[Variant, SteadyCase], Comparison]


class SteadyScenario(Scenario):
    """A scenario of steady states: subclasses say which, and what is expected of them.

    The first case is run with every variant, the others with those that were fast enough.
    """

    cases: ClassVar[tuple[SteadyCase, ...]]
    """The cases, the most informative first."""

    with_stick_slip: ClassVar[bool] = False
    """Whether stick and slip are compared beside the transmittance."""

    metrics: ClassVar[tuple[Metric, ...]] = (TRANSMITTANCE, PHASE, SAME_STEP)

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if cls.with_stick_slip:
            cls.metrics = (TRANSMITTANCE, PHASE, SAME_STEP, *STICK_SLIP_METRICS)

    def expected_by(self, case: SteadyCase) -> list[SteadyStateTask]:
        """Give the tasks from which `expected` is read: the exact motion, unless overridden."""
        return [case.task(EXACT)]

    def expected(self, case: SteadyCase, results: Sequence[Result]) -> Expected:
        """Give what the result of a case should be, from the results of `expected_by`."""
        return exact_expected(results[0])

    def stages(self) -> list[tuple[SteadyCase, ...]]:
        """Give the cases in the order in which they are run; a variant that is too slow in one stage skips the next."""
        return [self.cases[:1], self.cases[1:]]

    def growth(self, case: SteadyCase) -> float:
        """Give by how much longer a case takes than the slowest of the stage before."""
        return 1.0

    def period_tasks(self, variant: Variant) -> Mapping[str, SteadyStateTask]:
        """Compare a period in every case, with the steps that are judged."""
        return {case.label: case_tasks(variant, case)[1].recording(Recorded.LAW) for case in self.cases}

    def run(self, variants: Sequence[Variant], evaluator: Evaluator) -> list[Finding]:
        """Run every case with every variant; see `Scenario.run`."""
        results, skipped = self._simulated(variants, evaluator)

        def judged() -> list[Finding]:
            expected = {
                case: proven_expected(case, self.expected(case, [results[task] for task in self.expected_by(case)]))
                for case in self.cases
            }
            by_variant = (
                {
                    case: collect_evidence(variant, case, right, results, skipped.get((variant, case)))
                    for case, right in expected.items()
                }
                for variant in variants
            )
            return [finding for evidence in by_variant for finding in self.judged(evidence)]

        findings = judged()
        close = {(f.variant, f.case) for f in findings if f.comparison.verdict is Verdict.DISAGREE and not f.by_far}
        places = [(variant, case) for variant in variants for case in self.cases if (variant, case.label) in close]
        if not places:
            return findings
        results |= results_of([third_task(*place) for place in places], evaluator)
        return judged()

    def _simulated(self, variants: Sequence[Variant], evaluator: Evaluator) -> tuple[_Results, _Skipped]:
        """Run every case, stage after stage; gives the results, and why cases are skipped."""
        scheme = [task for case in self.cases for task in case_tasks(REFERENCE, case)]
        expected_by = [task for case in self.cases for task in self.expected_by(case)]
        results = results_of([*scheme, *expected_by], evaluator)
        skipped: _Skipped = {}
        before: tuple[SteadyCase, ...] = ()
        for cases in self.stages():
            for variant in variants:
                for case in cases:
                    reason = skip_reason(variant, before, self.growth(case), results)
                    if reason is not None:
                        skipped[variant, case] = reason
            due = [(variant, case) for variant in variants for case in cases if (variant, case) not in skipped]
            results |= results_of([task for variant, case in due for task in case_tasks(variant, case)], evaluator)
            before = cases
        return results, skipped

    def judged(self, by_case: Mapping[SteadyCase, Evidence]) -> list[Finding]:
        """Judge one variant in all cases."""
        return [finding for evidence in by_case.values() for finding in self.findings(evidence)]

    def findings(self, evidence: Evidence) -> list[Finding]:
        """Judge one variant in one case."""
        findings = [*response_findings(evidence), *same_step_findings(evidence)]
        if self.with_stick_slip:
            findings += stick_slip_findings(evidence)
        return findings if evidence.certified else [finding.uncertified() for finding in findings]


def proven_expected(case: SteadyCase, expected: Expected) -> Expected:
    """Expect the level and the phase that are proven, where the table has them."""
    level = proven_level(case.task(EXACT))
    if level is None or expected.missing is not None:
        return expected
    return replace(expected, **level.numbers, bar_db=0.0, phase_bar=0.0)


def point_case(friction_ratio: float, frequency_ratio: float, ratios: ChainRatios | None = None) -> SteadyCase:
    """Give a case that is named by both ratios; of the canonical chain unless another is given."""
    return SteadyCase(
        label=f"friction {friction_ratio:g}, η_r {frequency_ratio:g}",
        friction_ratio=friction_ratio,
        frequency_ratio=frequency_ratio,
        ratios=ratios or ChainRatios(),
    )


def cases_over(frequency_ratios: Iterable[float], friction_ratio: Ratio, ratios: ChainRatios) -> tuple[SteadyCase, ...]:
    """Give cases of one chain with one friction, named by their frequency ratios."""
    return tuple(
        SteadyCase(label=f"η_r {eta:g}", friction_ratio=friction_ratio, frequency_ratio=eta, ratios=ratios)
        for eta in frequency_ratios
    )


class ClosedForm(SteadyScenario):
    """A scenario of steady states whose motion is known in closed form: it needs no task."""

    def expected_by(self, case: SteadyCase) -> list[SteadyStateTask]:
        """A closed form needs no task."""
        return []


def results_of(tasks: Sequence[SteadyStateTask], evaluator: Evaluator) -> _Results:
    """Run tasks, each once."""
    unique = list(dict.fromkeys(tasks))
    return dict(zip(unique, evaluator.evaluate(unique), strict=True))


def skip_reason(
    variant: Variant, before: Sequence[SteadyCase], growth: float, results: Mapping[SteadyStateTask, Result]
) -> Comparison | None:
    """Give the reason to skip a variant, by its cases before; ``None`` without one."""
    costs = []
    for case in before:
        own = [results.get(task) for task in case_tasks(variant, case)]
        known = [result for result in own if result is not None]
        if len(known) < len(own):
            return Comparison(Verdict.INCONCLUSIVE, f"skipped, as {case.label} was")
        blocked = next((result for result in known if result.status is ResultStatus.BLOCKED), None)
        if blocked is not None:
            reason = f"skipped: blocked at {case.label}, {blocked.reason}"
            return Comparison(Verdict.BLOCKED, reason, failed=blocked.failed)
        costs.append((sum(result.seconds for result in known if math.isfinite(result.seconds)), case.label))
    seconds, label = max(costs, default=(0.0, ""))
    if growth * seconds <= LONGEST_SECONDS:
        return None
    reason = f"skipped: {label} took {seconds:.0f} s, this would take some {growth * seconds:.0f} s"
    return Comparison(Verdict.INCONCLUSIVE, f"{reason}, allowed {LONGEST_SECONDS:g} s")


def response_findings(evidence: Evidence) -> list[Finding]:
    """Compare transmittance and phase with what is expected; no phase where none is."""
    right, level = evidence.expected, evidence.expected.transmittance_db
    numbers = {TRANSMITTANCE: (level, right.bar_db), PHASE: (math.degrees(right.phase), right.phase_bar)}
    findings = []
    for metric, read in response_readers(level, right.phase).items():
        expected, bar = numbers[metric]
        value, comparison = math.nan, evidence.missing
        if comparison is None:
            value = read(evidence.fine)
            judged = judge(
                metric,
                evidence.steps(read),
                expected,
                bar=bar,
                scheme=evidence.scheme_steps(read, expected),
                resolution=of_amplitude(metric, evidence.resolution(level), level),
                effect=evidence.effect[metric],
            )
            comparison = of_response(judged, metric, level)
        findings.append(Finding(evidence.variant, evidence.case.label, metric, value, expected, comparison))
    return findings


def same_step_findings(evidence: Evidence) -> list[Finding]:
    """Compare a preset that shares the scheme with the reference at equal step; nothing for the others."""
    if evidence.variant.engine == REFERENCE.engine or not evidence.variant.preset.shares_scheme:
        return []
    value, expected = evidence.fine.transmittance_db, evidence.scheme[1].transmittance_db
    comparison = evidence.missing
    if comparison is None:
        apart = abs(_complex_transmittance(evidence.fine) - _complex_transmittance(evidence.scheme[1]))
        level = max(expected, FLOOR_DB)
        tolerance = Tolerance(resolution=evidence.resolution_db(level))
        comparison = decide(SAME_STEP, amplitude_in_db(apart, level), 0.0, tolerance)
    return [Finding(evidence.variant, evidence.case.label, SAME_STEP, value, expected, comparison)]


def _complex_transmittance(result: Result) -> complex:
    return cmath.rect(10 ** (result.transmittance_db / 20), result.phase)
