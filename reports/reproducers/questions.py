"""What a script shows: a number of a scenario, the motion that it is read from, and how."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.block.base import Throw
from multibody_xval.scenarios.catalogue.block.breakaway import FRACTION, LEAST_SPEED, Pull, slip_time
from multibody_xval.scenarios.catalogue.block.static_hold import CREEP, HOLD_TIME
from multibody_xval.scenarios.catalogue.block.stopping_distance import DISTANCE
from multibody_xval.scenarios.catalogue.descriptions import REFERENCE_REFINEMENT
from multibody_xval.scenarios.catalogue.motion import MotionCase, MotionScenario
from multibody_xval.scenarios.catalogue.registry import CATALOGUE
from multibody_xval.scenarios.catalogue.steady.figure3 import Figure3Points
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.task import SteadyStateTask
from multibody_xval.scenarios.runs.transient_task import TransientTask
from multibody_xval.scenarios.verdicts.finding import TRANSMITTANCE, Metric
from multibody_xval.scenarios.verdicts.judge import missing
from multibody_xval.scenarios.verdicts.steady_case import EXACT, REFERENCE, SteadyCase
from reference_lcp.chain.drives import HarmonicBase

PERIODS = 30
"""Of a steady state's script, from rest: by then friction and dashpots have taken most of what the start shook."""


@dataclass(frozen=True)
class Number:
    """What the suite says of a number: the variant's, NaN with the reason where it has none, and the exact one."""

    value: float
    exact: float
    reason: str = ""


class Question(ABC):
    """A number of one scenario."""

    scenario: ClassVar[str]
    metric: ClassVar[Metric]
    case: ClassVar[str]
    """The one that is shown unless another is named."""
    protocol: ClassVar[str] = ""
    """What the script does otherwise than the scenario; empty if nothing."""

    @abstractmethod
    def cases(self) -> Iterable[str]:
        """Give the names of all cases."""

    @abstractmethod
    def task(self, variant: Variant, case: str) -> TransientTask:
        """Give the motion from which the number is read."""

    @abstractmethod
    def number(self, variant: Variant, case: str, evaluator: Evaluator) -> Number:
        """Give the suite's own number."""

    @abstractmethod
    def readings(self, case: str, evaluator: Evaluator) -> Mapping[str, Any]:
        """Give the variables of the template that reads the number, which has the name of the scenario."""


class BlockQuestion(Question):
    """A number of one block."""

    @property
    def _scenario(self) -> MotionScenario[MotionCase]:
        scenario = CATALOGUE[self.scenario]
        assert isinstance(scenario, MotionScenario), "block questions are asked of scenarios of motions"
        return scenario

    def _case(self, case: str) -> MotionCase:
        return {str(each): each for each in self._scenario.cases}[case]

    def cases(self) -> Iterable[str]:
        return map(str, self._scenario.cases)

    def task(self, variant: Variant, case: str) -> TransientTask:
        return self._scenario.simulated(self._case(case).task(variant))[-1]

    def number(self, variant: Variant, case: str, evaluator: Evaluator) -> Number:
        findings = self._scenario.case_findings(variant, self._case(case), evaluator)
        finding = next(finding for finding in findings if finding.metric is self.metric)
        reason = finding.comparison.reason if np.isnan(finding.value) else ""
        return Number(finding.value, finding.expected, reason)


class StaticHoldQuestion(BlockQuestion):
    """How fast a block creeps."""

    scenario, metric, case = "static-hold", CREEP, "1 kg, load 0.99"

    def readings(self, case: str, evaluator: Evaluator) -> Mapping[str, Any]:
        return {"time": HOLD_TIME}


class BreakawayQuestion(BlockQuestion):
    """At which load a block slips."""

    scenario, metric, case = "breakaway", FRACTION, "1 kg, 2 ms"

    def readings(self, case: str, evaluator: Evaluator) -> Mapping[str, Any]:
        pull = self._case(case)
        assert isinstance(pull, Pull)
        (fine,) = evaluator.evaluate([pull.task(REFERENCE).refined(REFERENCE_REFINEMENT)])
        time = slip_time(pull, fine.series["slip_velocity"])
        return {"speed": LEAST_SPEED * pull.speed, "slip_time": time}


class StoppingQuestion(BlockQuestion):
    """How far a block slides, with the finest of the steps that are compared."""

    scenario, metric, case = "stopping-distance", DISTANCE, "1 kg, 4.9 m/s"

    def readings(self, case: str, evaluator: Evaluator) -> Mapping[str, Any]:
        throw = self._case(case)
        assert isinstance(throw, Throw)
        return {"velocity": throw.velocity, "distance": throw.distance}


class ChainQuestion(Question):
    """Transmittance of the chain at a point of Figure 3."""

    scenario, metric, case = "figure3", TRANSMITTANCE, "friction 0.6, η_r 0.9"
    protocol = f"the last of {PERIODS} periods from rest"

    def _case(self, case: str) -> SteadyCase:
        return {each.label: each for each in Figure3Points.cases}[case]

    def _steady(self, case: str, variant: Variant) -> SteadyStateTask:
        return self._case(case).task(variant)

    def cases(self) -> Iterable[str]:
        return [case.label for case in Figure3Points.cases]

    def task(self, variant: Variant, case: str) -> TransientTask:
        steady = self._steady(case, variant)
        lane, _ = steady.lane()
        assert isinstance(lane.drive, HarmonicBase), "figure 3 is driven at its base"
        return TransientTask(
            variant=variant,
            friction_ratio=steady.friction_ratio,
            ratios=steady.ratios,
            base=lane.drive,
            time_step=lane.time_step,
            steps=PERIODS * steady.steps_per_period,
        )

    def number(self, variant: Variant, case: str, evaluator: Evaluator) -> Number:
        steps = self._steady(case, variant).steps_per_period
        own, exact = evaluator.evaluate([self.task(variant, case), self.task(EXACT, case)])
        value, expected = (_transmittance(result, steps) for result in (own, exact))
        gap = missing("", [own]) or missing("exact", [exact])
        return Number(value, expected, "" if gap is None else gap.reason)

    def readings(self, case: str, evaluator: Evaluator) -> Mapping[str, Any]:
        steady = self._steady(case, REFERENCE)
        _, drive = steady.setting()
        return {
            "periods": PERIODS,
            "steps": steady.steps_per_period,
            "omega": 2 * np.pi / drive.period,
            "base": drive.displacement_scale(steady.chain),
        }


def _transmittance(result: Result, steps: int) -> float:
    """Give the fundamental of the last period of so many steps [dB]; NaN without a motion."""
    if missing("", [result]) is not None:
        return np.nan
    response = np.array(result.series["response"])[-steps:]
    amplitude = 2 * abs(np.mean(response * np.exp(-2j * np.pi * np.arange(1, steps + 1) / steps)))
    return float(20 * np.log10(amplitude))


QUESTIONS: Mapping[str, Question] = MappingProxyType({
    question.scenario: question
    for question in (StaticHoldQuestion(), BreakawayQuestion(), StoppingQuestion(), ChainQuestion())
})  # fmt: skip
"""What can be reproduced, by the name of the scenario."""
