"""An engine whose error is in proportion to its step, and large: what agrees by that alone shows nothing."""

import dataclasses
from functools import cache

import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.motion import MotionScenario
from multibody_xval.scenarios.catalogue.registry import CATALOGUE
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.executor import InProcessExecutor
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.store import opened_store
from multibody_xval.scenarios.runs.transient import run_transients
from multibody_xval.scenarios.runs.transient_task import TransientTask
from multibody_xval.scenarios.verdicts.finding import Finding, Verdict
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE

USUAL = Variant("exudyn-regularised", "contact")

MOTIONS = dict.fromkeys(("published", "free-decay", "stopping-distance", "direction", "ricker-pulse"), USUAL) | {
    "static-above-kinetic": Variant("exudyn-regularised"),
}
"""Scenarios, and a variant that can represent them: the test needs no more of it."""


@cache
def reference_motion(task: TransientTask) -> Result:
    return run_transients([task])[0]


class Stretched(InProcessExecutor):
    """The engine is the reference, its motion stretched by `part` with the coarsest step, and by less with finer ones.

    By as much with every step, where the error does `stay`.
    """

    def __init__(self, coarsest: TransientTask, part: float, *, stay: bool):
        self.variant, self.coarsest, self.part, self.stay = coarsest.variant, coarsest.steps, part, stay

    def run(self, batches):
        for batch in batches:
            own = batch[0].variant == self.variant
            yield batch, [self.stretched(task) if own else reference_motion(task) for task in batch]

    def stretched(self, task):
        answer = reference_motion(dataclasses.replace(task, variant=REFERENCE))
        factor = 1 + self.part * (1.0 if self.stay else self.coarsest / task.steps)
        series = {name: tuple(factor * number for number in own) for name, own in answer.series.items()}
        return dataclasses.replace(answer, series=series)


def judged(name: str, part: float, *, stay: bool = False) -> list[Finding]:
    """Judge the first case of a scenario."""
    scenario = CATALOGUE[name]
    assert isinstance(scenario, MotionScenario)
    case = scenario.cases[0]
    short = type(name, (type(scenario),), {"cases": (case,)})()
    variant = MOTIONS[name]
    with opened_store(None) as store:
        return short.run([variant], Evaluator(store, Stretched(case.task(variant), part, stay=stay)))


def far_off(finding: Finding) -> bool:
    """Whether a number that is resolved is off by more than a tenth of what is expected, or of one beside zero.

    Not asked of numbers in dB, whose size is that of an amplitude.
    """
    allowed = max(0.1 * (abs(finding.expected) or 1.0), finding.comparison.resolution)
    return finding.metric.unit != "dB" and abs(finding.comparison.difference) > allowed


@pytest.mark.slow
@pytest.mark.parametrize("name", MOTIONS)
def test_number_that_agrees_only_by_its_coarse_step_is_inconclusive(name) -> None:
    findings = judged(name, 2.0)
    assert Verdict.TOO_COARSE in {finding.comparison.verdict for finding in findings}
    agreeing = [finding for finding in findings if finding.comparison.verdict is Verdict.AGREE]
    assert [finding for finding in agreeing if far_off(finding)] == []


@pytest.mark.parametrize("name", MOTIONS)
def test_engine_whose_step_is_fine_enough_agrees(name) -> None:
    assert {finding.comparison.verdict for finding in judged(name, 0.01)} == {Verdict.AGREE}


@pytest.mark.parametrize("name", MOTIONS)
def test_engine_that_is_wrong_with_every_step_disagrees(name) -> None:
    assert Verdict.DISAGREE in {finding.comparison.verdict for finding in judged(name, 0.5, stay=True)}
