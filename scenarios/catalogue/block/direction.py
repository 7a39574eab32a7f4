"""Direction: the bound of friction along a row that is turned in the plane of its contact, a rose."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from engines.interface.presets import Formulation
from engines.interface.variant import Variant
from reference_lcp.chain.drives import StillBase
from reference_lcp.steady.error_bar import REFINEMENTS
from scenarios.catalogue.block.base import ROUND_OFF, ROUNDINGS, SCALES, TIME_STEP, BlockScenario, Scale
from scenarios.catalogue.descriptions import DESCRIPTIONS
from scenarios.catalogue.transient.base import read_refined, with_refined_steps
from scenarios.runs.evaluator import Evaluator
from scenarios.runs.result import NamedNumbers
from scenarios.runs.transient_task import BlockTask
from scenarios.verdicts.finding import Comparison, Finding, Metric, Prediction, Verdict
from scenarios.verdicts.judge import Steps, judge
from scenarios.verdicts.steady_case import EXACT, REFERENCE

ANGLES = (0, 15, 30, 45, 60, 75, 90)
"""By which the row is turned [°]: pyramids of four faces are seen at their edges and at their faces."""

STOPPING_TIMES = (0.1, 1.0)
"""T = v m / (μ λ_N) [s]: a fast and a slow slip, since some engines have a velocity of their own."""

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


class Slide(NamedTuple):
    """One case: a scale, the time in which friction would stop the block, and a direction."""

    scale: Scale
    time: float
    angle: int

    @property
    def velocity(self) -> float:
        """Velocity of the slip at first [m/s]."""
        block = self.scale.block(1.0)
        return block.bound / block.mass * self.time

    @property
    def straight(self) -> "Slide":
        """The same in a row that is not turned."""
        return self._replace(angle=0)

    def task(self, variant: Variant) -> BlockTask:
        """Give the task of a variant, with its coarsest step."""
        distance = self.velocity * self.time / 2
        return BlockTask(
            variant=variant,
            block=self.scale.block(SPRING_LENGTH * distance),
            base=StillBase(distance),
            slip_velocity=self.velocity,
            direction=math.radians(self.angle),
            time_step=TIME_STEP,
            steps=round(PART * self.time / TIME_STEP),
        )

    def __str__(self) -> str:
        return f"{self.scale.title}, {self.velocity:.3g} m/s, {self.angle}°"


SLIDES = {
    str(slide): slide
    for scale in SCALES
    for time in STOPPING_TIMES
    for angle in ANGLES
    for slide in (Slide(scale, time, angle),)
}


class Direction(BlockScenario):
    """Coulomb's cone is round; pyramids have edges, by which friction is too large, or faces, by which too small."""

    name = "direction"
    question, expects = DESCRIPTIONS[name]
    source = "Coulomb's law: |λ_T| = μ λ_N against the slip. As users ask it: RobotLocomotion/drake, issue 18932."
    metrics = (BOUND,)

    def parameters(self) -> list[str]:
        """Give the steps; see `Scenario.parameters`."""
        steps = ", ".join(f"{1e3 * TIME_STEP / factor:g}" for factor in REFINEMENTS)
        return [f"steps of {steps} ms; followed until friction has taken {PART:g} of the velocity"]

    def tasks_by_case(self, variant: Variant) -> Mapping[str, BlockTask]:
        """Give the tasks; see `BlockScenario.tasks_by_case`."""
        return {case: slide.task(variant) for case, slide in SLIDES.items()}

    def baseline(self) -> list[BlockTask]:
        """Give the exact motions, of rows that are not turned."""
        return [slide.straight.task(EXACT) for slide in SLIDES.values()]

    def simulated(self, task: BlockTask) -> list[BlockTask]:
        """Give a task with three step sizes; none of a joint's."""
        return [] if _is_joint(task.variant) else with_refined_steps(task)

    def judged(self, variant: Variant, case: str, task: BlockTask, evaluator: Evaluator) -> list[Finding]:
        """Compare with the exact motion; where the preset states another bound, with that as well."""
        if _is_joint(variant):
            gap = Comparison(Verdict.BLOCKED, NO_DIRECTION)
            return Finding.without_numbers(variant, case, self.metrics, gap)
        own = _read(SLIDES[case], task, evaluator)
        if isinstance(own, Comparison):
            return Finding.without_numbers(variant, case, self.metrics, own)
        comparison = judge(BOUND, own, 1.0, resolution=_resolution(task), effect=1.0)
        value = float(own.judged)
        prediction = None if comparison.verdict is Verdict.AGREE else _predicted(SLIDES[case], task, value, evaluator)
        return [Finding(variant, case, BOUND, value, 1.0, comparison, prediction)]


def _is_joint(variant: Variant) -> bool:
    return variant.formulation == Formulation.JOINT and variant.engine != REFERENCE.engine


def _read(slide: Slide, task: BlockTask, evaluator: Evaluator) -> Steps | Comparison:
    """Read the loss of slip velocity over that of the exact motion, with three step sizes; or why there is none."""
    (exact,) = evaluator.evaluate([slide.straight.task(EXACT)])

    def lost(series: NamedNumbers) -> float:
        return slide.velocity - series["slip_velocity"][-1]

    read = read_refined(task, evaluator, lambda series: {BOUND: lost(series) / lost(exact.series)})
    return read if isinstance(read, Comparison) else read[BOUND]


def _resolution(task: BlockTask) -> float:
    """Give what springs, roundings of velocities and the stated residual slip compliance leave open of the bound."""
    rounding = ROUNDINGS * ROUND_OFF[task.variant.capabilities.precision] * math.sqrt(task.steps) / PART
    preset = task.variant.preset
    stated = preset if task.lane().preload is None else preset.modulated()
    return LEFT_BY_SPRINGS + rounding + stated.residual_slip_compliance


def _predicted(slide: Slide, task: BlockTask, value: float, evaluator: Evaluator) -> Prediction | None:
    """Compare the whole motion with the reference's under the bound that the preset states."""
    stated = task.variant.preset.turned_bound
    if stated is None:
        return None
    bound = stated(task.lane(), task.slip_velocity)
    pressed = replace(task.block, normal_force=bound * task.block.normal_force)
    harder = replace(slide.straight.task(REFERENCE), block=pressed)
    predicted = _read(slide, harder, evaluator)
    if isinstance(predicted, Comparison):
        return None
    left_open = _resolution(task)
    slip, under_bound = (np.array(result.series["slip"]) for result in evaluator.evaluate([task, harder]))
    return Prediction(
        value=float(predicted.judged),
        difference=value - float(predicted.judged),
        allowed=left_open,
        distance=float(np.max(np.abs(slip - under_bound))),
        period_bound=left_open,
    )
