"""What the questions about one block share: its scales, its tasks, and how its law is compared with its engine.

Motions are compared as they are: two under one drive never drift apart, since friction with a given normal force is
monotone, as long as it is as large at rest as in motion.
"""

import math
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from engines.interface.tolerances import SINGLE
from engines.interface.variant import Variant
from scenarios.catalogue.base import Scenario, motion_distance
from scenarios.runs.evaluator import Evaluator
from scenarios.runs.transient_task import Block, BlockTask
from scenarios.verdicts.finding import Comparison, Finding, Metric
from scenarios.verdicts.judge import Steps, judge
from scenarios.verdicts.prediction import LawPeriod
from scenarios.verdicts.steady_case import REFERENCE

STANDARD_GRAVITY = 9.80665
"""g [m/s²]."""

TIME_STEP = 0.002
"""dt [s], the default of MuJoCo and a usual one of others; none is chosen for a scale of mass or force."""

ROUND_OFF = {"double": 2.0**-53, "single": SINGLE}
"""Largest rounding of a number, as a part of it."""

ROUNDINGS = 8
"""Of a position in a step: in forces, velocities and positions, and in as many substeps."""


@dataclass(frozen=True)
class Scale:
    """Mass and force of a block."""

    title: str
    mass: float
    """Of the block [kg]."""
    weights: float = 1.0

    @property
    def normal_force(self) -> float:
        """λ_N [N]."""
        return self.weights * self.mass * STANDARD_GRAVITY

    def block(self, stiffness_length: float) -> Block:
        """Give the block, with a spring that is as strong as friction once it is this long [m]."""
        bound = Block(mass=self.mass, normal_force=self.normal_force, stiffness=1.0).bound
        return Block(mass=self.mass, normal_force=self.normal_force, stiffness=bound / stiffness_length)


SCALES = (Scale("1 g", 1e-3), Scale("1 kg", 1.0), Scale("1 t under 10 t", 1e3, 10.0))


class BlockScenario(Scenario):
    """A question about one block; a case is one scale with one value of what is varied."""

    @abstractmethod
    def tasks_by_case(self, variant: Variant) -> Mapping[str, BlockTask]:
        """Give the tasks of a variant by case, with the step that is judged."""

    @abstractmethod
    def judged(self, variant: Variant, case: str, task: BlockTask, evaluator: Evaluator) -> list[Finding]:
        """Compare one case with what is expected, a finding a metric."""

    def baseline(self) -> list[BlockTask]:
        """Give the tasks that the others are compared with."""
        return []

    def simulated(self, task: BlockTask) -> list[BlockTask]:
        """Give the tasks that a case needs, that which is judged last: with its own step alone, unless overridden."""
        return [task]

    def run(self, variants: Sequence[Variant], evaluator: Evaluator) -> list[Finding]:
        """Run every case with every variant; see `Scenario.run`."""
        cases = {variant: self.tasks_by_case(variant) for variant in dict.fromkeys((REFERENCE, *variants))}
        every = [each for tasks in cases.values() for task in tasks.values() for each in self.simulated(task)]
        evaluator.evaluate([*self.baseline(), *every])
        return [
            finding
            for variant in variants
            for case, task in cases[variant].items()
            for finding in self.judged(variant, case, task, evaluator)
        ]

    def law_periods(self, variant: Variant, evaluator: Evaluator) -> Mapping[str, LawPeriod]:
        """Compare the whole motion of every case, with the step that is judged, with the law's from the same state."""
        by_law = variant.law
        assert by_law is not None, "only variants with a law are compared with one"
        tasks, laws = (
            {case: self.simulated(task)[-1] for case, task in self.tasks_by_case(each).items()}
            for each in (variant, by_law)
        )
        evaluator.evaluate([*tasks.values(), *laws.values()])
        return {case: motion_distance(task, laws[case], "slip", evaluator) for case, task in tasks.items()}


def round_off(task: BlockTask) -> float:
    """Give by how much roundings of positions move a slip over a motion [m]: they add up as the root of their number.

    The largest position is that of the base, or the slip at first.
    """
    base = task.base.displacement_scale(task.chain)
    largest = max(base, abs(task.slip), abs(task.slip_velocity) * task.steps * task.time_step)
    return ROUNDINGS * ROUND_OFF[task.variant.capabilities.precision] * largest * float(np.sqrt(task.steps))


def judged_at_one_step(metric: Metric, value: float, task: BlockTask, time: float) -> Comparison:
    """Compare a slip [µm], or a velocity [µm/s] from two that are `time` [s] apart, with none at all.

    Whatever the step, Coulomb friction lets nothing slip: an error that gets smaller with the step is none that is
    allowed. Round-off is, and the residual slip compliance that the preset states: that part of the velocity which
    friction takes away in a step.
    """
    lane, preset = task.lane(), task.variant.preset
    stated = preset if lane.preload is None else preset.modulated()
    inverse_mass = float(1 / task.chain.inner_mass[0] + 1 / task.chain.outer_mass[0])
    speed = stated.residual_slip_compliance * task.block.bound * inverse_mass * task.time_step
    if math.isinf(time):
        allowed, per_amplitude = speed * task.every * task.time_step + round_off(task), 1.0
    else:
        allowed, per_amplitude = speed + round_off(task) / time, 1 / time
    comparison = judge(metric, Steps({1: value}), 0.0, resolution=1e6 * allowed)
    return replace(comparison, per_amplitude=1e6 * per_amplitude * task.base.displacement_scale(lane.chain))
