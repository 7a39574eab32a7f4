"""Scenarios whose cases are motions from a state: each with three step sizes, beside what is expected of it."""

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import ClassVar, Generic, NamedTuple, Protocol, TypeVar

import numpy as np

from multibody_xval.engines.interface.registry import law_of
from multibody_xval.engines.interface.tolerances import STEPS
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.base import Scenario
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.result import NamedNumbers, ResultStatus
from multibody_xval.scenarios.runs.transient_task import TransientTask
from multibody_xval.scenarios.verdicts.finding import Comparison, Finding, Metric
from multibody_xval.scenarios.verdicts.judge import Number, Steps, judge, missing
from multibody_xval.scenarios.verdicts.prediction import LawPeriod
from multibody_xval.scenarios.verdicts.steady_case import EXACT, REFERENCE
from reference_lcp.steady.error_bar import REFINEMENTS


class MotionCase(Protocol):
    """One case; tables print it as a string."""

    def task(self, variant: Variant) -> TransientTask:
        """Give the task of a variant, with its coarsest step."""


Case = TypeVar("Case", bound=MotionCase)

Readings = Mapping[Metric, Steps]
"""What is compared, by step size."""


class NothingToCompare(Exception):
    """A result that a comparison needs is missing, for the reason of the comparison that it carries."""

    def __init__(self, comparison: Comparison):
        super().__init__(comparison.reason)
        self.comparison = comparison


class Read(NamedTuple):
    """What is read of a variant, of the reference in the same steps, and what is expected."""

    own: Readings
    scheme: Readings
    expected: Readings

    def finding(
        self,
        variant: Variant,
        case: MotionCase,
        metric: Metric,
        *,
        resolution: float = 0.0,
        own: float = 0.0,
        effect: float | None = None,
    ) -> Finding:
        """Compare one number; of a series, its largest difference. For what is allowed see `judge`."""
        values, expected = self.own[metric], self.expected[metric]
        comparison = judge(
            metric,
            values,
            expected.judged,
            bar=expected.error(metric),
            scheme=self.scheme.get(metric),
            resolution=resolution,
            own=own,
            effect=effect,
        )
        if isinstance(expected.judged, np.ndarray):
            return Finding(variant, str(case), metric, comparison.difference, 0.0, comparison)
        return Finding(variant, str(case), metric, float(values.judged), float(expected.judged), comparison)

    def over_expected(self) -> "Read":
        """Give the same over what is expected."""
        return Read(*(
            {
                metric: Steps({count: value / self.expected[metric].judged for count, value in steps.values.items()})
                for metric, steps in readings.items()
            }
            for readings in self
        ))  # fmt: skip


class MotionScenario(Scenario, Generic[Case]):
    """A scenario of motions: subclasses say which, what is read of them, and how it is judged."""

    law_series: ClassVar[str] = ""
    """Series whose difference in the whole motion is that from the law; without one, periods are compared."""

    @property
    @abstractmethod
    def cases(self) -> Sequence[Case]:
        """The cases, in the order in which they are printed."""

    @abstractmethod
    def numbers(self, case: Case, series: NamedNumbers) -> Mapping[Metric, Number]:
        """Read what is compared from the series of a motion, with any step."""

    @abstractmethod
    def judged(self, variant: Variant, case: Case, evaluator: Evaluator) -> list[Finding]:
        """Compare one case with what is expected, a finding a metric."""

    def case_metrics(self, case: Case) -> Sequence[Metric]:
        """Give what is compared in a case: everything, unless overridden."""
        return self.metrics

    def baseline(self, case: Case) -> list[TransientTask]:
        """Give the tasks from which is read what is expected: the exact motion, unless overridden."""
        return [case.task(EXACT)]

    def simulated(self, task: TransientTask) -> list[TransientTask]:
        """Give the tasks that a case needs, that which is judged last: three step sizes, unless overridden."""
        return with_refined_steps(task)

    def tasks(self, variants: Sequence[Variant]) -> list[TransientTask]:
        """Give all tasks that are known from the start."""
        own = [case.task(variant) for variant in dict.fromkeys((REFERENCE, *variants)) for case in self.cases]
        baseline = [task for case in self.cases for task in self.baseline(case)]
        return [*baseline, *(task for coarsest in own for task in self.simulated(coarsest))]

    def run(self, variants: Sequence[Variant], evaluator: Evaluator) -> list[Finding]:
        """Run every case with every variant; see `Scenario.run`."""
        evaluator.evaluate(self.tasks(variants))
        return [
            finding
            for variant in variants
            for case in self.cases
            for finding in self.case_findings(variant, case, evaluator)
        ]

    def case_findings(self, variant: Variant, case: Case, evaluator: Evaluator) -> list[Finding]:
        """Judge one case; where nothing can be compared, the findings say why."""
        try:
            return self.judged(variant, case, evaluator)
        except NothingToCompare as gap:
            return Finding.without_numbers(variant, str(case), self.case_metrics(case), gap.comparison)

    def read(self, case: Case, tasks: Sequence[TransientTask], evaluator: Evaluator) -> Readings:
        """Read a motion with several step sizes."""
        results = evaluator.evaluate(tasks)
        exact, reference = tasks[0].variant == EXACT, tasks[0].variant.engine == REFERENCE.engine
        gap = missing("exact motion" if exact else "reference" if reference else "", results)
        if gap is not None:
            raise NothingToCompare(gap)
        read = {task.steps: self.numbers(case, result.series) for task, result in zip(tasks, results, strict=True)}
        metrics = next(iter(read.values()))
        return {metric: Steps({steps: values[metric] for steps, values in read.items()}) for metric in metrics}

    def read_beside(self, case: Case, task: TransientTask, evaluator: Evaluator, *, scheme: bool = True) -> Read:
        """Read a task with its step sizes, the reference in the same steps, and what is expected."""
        reference = self.simulated(case.task(REFERENCE)) if scheme else []
        motions = self.simulated(task), reference, self.baseline(case)
        evaluator.evaluate([each for tasks in motions for each in tasks])
        return Read(*(self.read(case, tasks, evaluator) if tasks else {} for tasks in motions))

    def law_periods(self, variant: Variant, evaluator: Evaluator) -> Mapping[str, LawPeriod]:
        """Compare the whole motion of every case, with the step that is judged, with the law's from the same state."""
        if not self.law_series:
            return super().law_periods(variant, evaluator)
        model = self.law_variant(variant)
        assert model is not None, "only variants with a law are compared with one"
        own, predicted = (
            {str(case): self.simulated(case.task(each))[-1] for case in self.cases} for each in (variant, model)
        )
        evaluator.evaluate([*own.values(), *predicted.values()])
        return {case: motion_distance(task, predicted[case], self.law_series, evaluator) for case, task in own.items()}


def with_refined_steps(coarsest: TransientTask) -> list[TransientTask]:
    """Give the tasks of a motion with three step sizes, its own first."""
    return [coarsest.refined(factor) for factor in REFINEMENTS]


def refined_counts(steps: int) -> str:
    """Give the numbers of steps of three step sizes, as tables print them."""
    return ", ".join(str(steps * factor) for factor in REFINEMENTS)


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
