"""Stopping distance: a block that is thrown over its carrier stops after v² / (2 μ λ_N / m), and stays there."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from engines.interface.variant import Variant
from reference_lcp.chain.drives import StillBase
from reference_lcp.steady.error_bar import REFINEMENTS
from reference_lcp.validation import FloatArray
from scenarios.catalogue.block.base import SCALES, TIME_STEP, BlockScenario, Scale, judged_at_one_step, round_off
from scenarios.catalogue.descriptions import DESCRIPTIONS
from scenarios.catalogue.transient.base import read_refined, with_refined_steps
from scenarios.runs.evaluator import Evaluator
from scenarios.runs.result import NamedNumbers
from scenarios.runs.transient_task import BlockTask
from scenarios.verdicts.finding import Comparison, Finding, Metric
from scenarios.verdicts.judge import Number, judge
from scenarios.verdicts.steady_case import EXACT, REFERENCE

STOPPING_TIMES = (0.25, 1.0)
"""T = v m / (μ λ_N) [s], which gives v."""

FOLLOWED = 2
"""Times the stopping time for which a motion is followed."""

SPRING_LENGTH = 1e4
"""Length over the stopping distance at which the spring pulls with the bound of friction: it hardly does."""

DISTANCE = Metric("distance", "", "Slip in the end over v² m / (2 μ λ_N).")
TIME = Metric("time", "", "When the block came within a thousandth of its way of where it is in the end, over T.")
DRIFT = Metric("drift", "µm/s", "Mean velocity of the slip in the last quarter of the time, at rest.")

NEAR = 1e-3
"""Of the way: with a constant deceleration it is reached at 1 − √0.001 of the stopping time."""


class Throw(NamedTuple):
    """One case: a scale, and the time to rest."""

    scale: Scale
    time: float

    @property
    def distance(self) -> float:
        """v² m / (2 μ λ_N) [m]."""
        return self.velocity * self.time / 2

    @property
    def velocity(self) -> float:
        """Velocity at first [m/s]."""
        block = self.scale.block(1.0)
        return block.bound / block.mass * self.time

    def task(self, variant: Variant) -> BlockTask:
        """Give the task of a variant, with its coarsest step."""
        return BlockTask(
            variant=variant,
            block=self.scale.block(SPRING_LENGTH * self.distance),
            base=StillBase(self.distance),
            slip_velocity=self.velocity,
            time_step=TIME_STEP,
            steps=round(FOLLOWED * self.time / TIME_STEP),
        )

    def __str__(self) -> str:
        return f"{self.scale.title}, {self.velocity:.3g} m/s"


THROWS = {str(throw): throw for scale in SCALES for time in STOPPING_TIMES for throw in (Throw(scale, time),)}


class StoppingDistance(BlockScenario):
    """Sliding friction takes the velocity away at μ λ_N / m, and friction at rest keeps the block where it stops."""

    name = "stopping-distance"
    question, expects = DESCRIPTIONS[name]
    source = "Motion under a constant force, v² / (2 μ g) of a block under its own weight: any textbook of mechanics."
    metrics = (DISTANCE, TIME, DRIFT)

    def parameters(self) -> list[str]:
        """Give the steps; see `Scenario.parameters`."""
        steps = ", ".join(f"{1e3 * TIME_STEP / factor:g}" for factor in REFINEMENTS)
        return [f"steps of {steps} ms; followed for {FOLLOWED} times the time to rest"]

    def tasks_by_case(self, variant: Variant) -> Mapping[str, BlockTask]:
        """Give the tasks; see `BlockScenario.tasks_by_case`."""
        return {case: throw.task(variant) for case, throw in THROWS.items()}

    def baseline(self) -> list[BlockTask]:
        """Give the exact motions."""
        return [throw.task(EXACT) for throw in THROWS.values()]

    def simulated(self, task: BlockTask) -> list[BlockTask]:
        """Give a task with three step sizes."""
        return with_refined_steps(task)

    def judged(self, variant: Variant, case: str, task: BlockTask, evaluator: Evaluator) -> list[Finding]:
        """Compare with the exact motion, at rows of the coarsest step; the scheme's own error is allowed."""
        throw = THROWS[case]

        def numbers(series: NamedNumbers) -> Mapping[Metric, Number]:
            return _numbers(throw, np.array(series["slip"]))

        own, scheme = (read_refined(throw.task(each), evaluator, numbers) for each in (variant, REFERENCE))
        (exact,) = evaluator.evaluate([throw.task(EXACT)])
        if isinstance(own, Comparison) or isinstance(scheme, Comparison):
            gap = own if isinstance(own, Comparison) else scheme
            assert isinstance(gap, Comparison)
            return Finding.without_numbers(variant, case, self.metrics, gap)
        expected = numbers(exact.series)
        rows = 2 * FOLLOWED / len(exact.series["slip"])  # one of each reading
        comparisons = {
            metric: judge(metric, own[metric], expected[metric], scheme=scheme[metric], resolution=resolution)
            for metric, resolution in ((DISTANCE, round_off(task) / throw.distance), (TIME, rows))
        }
        drift = float(own[DRIFT].judged)
        comparisons[DRIFT] = judged_at_one_step(DRIFT, drift, task, FOLLOWED * throw.time / 4)
        return [
            Finding(variant, case, metric, float(own[metric].judged), float(expected[metric]), comparison)
            for metric, comparison in comparisons.items()
        ]


def _numbers(throw: Throw, slip: FloatArray) -> dict[Metric, Number]:
    """Read what is compared from the slip over the stopping distance, at the rows of the coarsest step."""
    away = np.abs(slip - slip[-1]) > NEAR * abs(slip[-1])
    last = int(np.flatnonzero(away)[-1]) + 1 if np.any(away) else 0
    time = FOLLOWED * throw.time / slip.size
    quarter = slip.size // 4
    return {
        DISTANCE: float(slip[-1]),
        TIME: (last + 1) * time / throw.time,
        DRIFT: 1e6 * throw.distance * float(slip[-1] - slip[-1 - quarter]) / (quarter * time),
    }
