"""Direction: the bound of friction along a row that is turned in the plane of its contact, a rose."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.block.base import (
    ROUND_OFF,
    ROUNDINGS,
    SCALES,
    THREE_STEPS,
    BlockScenario,
    Throw,
    stated_compliance,
)
from multibody_xval.scenarios.catalogue.motion import NothingToCompare
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.result import NamedNumbers
from multibody_xval.scenarios.runs.transient_task import BlockTask, TransientTask
from multibody_xval.scenarios.verdicts.finding import Comparison, Finding, Metric, Prediction, Verdict
from multibody_xval.scenarios.verdicts.judge import Number
from multibody_xval.scenarios.verdicts.steady_case import EXACT, REFERENCE

ANGLES = (0, 15, 30, 45, 60, 75, 90)
"""By which the row is turned [°]: pyramids of four faces are seen at their edges and at their faces."""

STOPPING_TIMES = (0.1, 1.0)
"""A fast and a slow slip, since some engines have a velocity of their own [s]."""

PART = 0.2
"""Of the velocity that friction takes off: sideways forces of a pyramid turn the slip by a tenth of that at most."""

SPRING_LENGTH = 1e6
"""Length over the stopping distance at which the spring pulls with the bound of friction: it hardly does."""

BOUND = Metric("bound", "", "Loss of slip velocity over that of the exact motion: mean friction over μ λ_N.")

LEFT_BY_SPRINGS = 1e-5
"""Of the bound: what the springs of the chain make of it. Friction that is off by 40 % moves the block 1e-6 of the
spring's length less, and all that it does to the carrier is in proportion."""

NO_DIRECTION = "the friction of a joint has no direction: it acts along the joint alone"
"""Why joints do not take part."""


@dataclass(frozen=True)
class Slide(Throw):
    """One case: a scale, the time in which friction would stop the block, and a direction."""

    angle: int

    @property
    def straight(self) -> "Slide":
        """The same in a row that is not turned."""
        return replace(self, angle=0)

    def task(self, variant: Variant) -> BlockTask:
        """Give the task of a variant, with its coarsest step."""
        return self.thrown(variant, SPRING_LENGTH, PART, math.radians(self.angle))

    def __str__(self) -> str:
        return f"{self.scale.title}, {self.velocity:.3g} m/s, {self.angle}°"


class Direction(BlockScenario[Slide]):
    """Coulomb's cone is round; pyramids have edges, by which friction is too large, or faces, by which too small."""

    name = "direction"
    source = "Coulomb's law: |λ_T| = μ λ_N against the slip. As users ask it: RobotLocomotion/drake, issue 18932."
    metrics = (BOUND,)
    cases = tuple(Slide(scale, time, angle) for scale in SCALES for time in STOPPING_TIMES for angle in ANGLES)

    def parameters(self) -> list[str]:
        """Give the steps; see `Scenario.parameters`."""
        return [f"steps of {THREE_STEPS}; followed until friction has taken {PART:g} of the velocity"]

    def baseline(self, case: Slide) -> list[TransientTask]:
        """Give the exact motion, in a row that is not turned."""
        return [case.straight.task(EXACT)]

    def simulated(self, task: TransientTask) -> list[TransientTask]:
        """Give a task with three step sizes; none of a joint's."""
        return [] if _is_joint(task.variant) else super().simulated(task)

    def numbers(self, case: Slide, series: NamedNumbers) -> Mapping[Metric, Number]:
        """Read the loss of slip velocity."""
        return {BOUND: case.velocity - series["slip_velocity"][-1]}

    def judged(self, variant: Variant, case: Slide, evaluator: Evaluator) -> list[Finding]:
        """Compare with the exact motion; where the preset states another bound, with that as well."""
        if _is_joint(variant):
            raise NothingToCompare(Comparison(Verdict.BLOCKED, NO_DIRECTION))
        task = case.task(variant)
        read = self.read_beside(case, task, evaluator, scheme=False).over_expected()
        finding = read.finding(variant, case, BOUND, resolution=_resolution(task))
        if finding.comparison.verdict is Verdict.AGREE:
            return [finding]
        return [replace(finding, prediction=self._predicted(case, task, finding.value, evaluator))]

    def _predicted(self, slide: Slide, task: BlockTask, value: float, evaluator: Evaluator) -> Prediction | None:
        """Compare the whole motion with the reference's under the bound that the preset states."""
        stated = task.variant.preset.turned_bound
        if stated is None:
            return None
        bound = stated(task.lane(), task.slip_velocity)
        pressed = replace(task.block, normal_force=bound * task.block.normal_force)
        harder = replace(slide.straight.task(REFERENCE), block=pressed)
        try:
            read = self.read_beside(slide, harder, evaluator, scheme=False).over_expected()
        except NothingToCompare:
            return None
        predicted, left_open = float(read.own[BOUND].judged), _resolution(task)
        slip, under_bound = (np.array(result.series["slip"]) for result in evaluator.evaluate([task, harder]))
        return Prediction(
            value=predicted,
            difference=value - predicted,
            allowed=left_open,
            distance=float(np.max(np.abs(slip - under_bound))),
            period_bound=left_open,
        )


def _is_joint(variant: Variant) -> bool:
    return variant.formulation == Formulation.JOINT and variant.engine != REFERENCE.engine


def _resolution(task: BlockTask) -> float:
    """Give what springs, roundings of velocities and the stated residual slip compliance leave open of the bound."""
    rounding = ROUNDINGS * ROUND_OFF[task.variant.capabilities.precision] * math.sqrt(task.steps) / PART
    return LEFT_BY_SPRINGS + rounding + stated_compliance(task)
