"""Stopping distance: a block that is thrown over its carrier stops after v² / (2 μ λ_N / m), and stays there."""

from collections.abc import Mapping

import numpy as np

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.block.base import (
    SCALES,
    THREE_STEPS,
    BlockScenario,
    Throw,
    judged_at_one_step,
    round_off,
)
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.result import NamedNumbers
from multibody_xval.scenarios.runs.transient_task import BlockTask
from multibody_xval.scenarios.verdicts.finding import Finding, Metric
from multibody_xval.scenarios.verdicts.judge import Number

STOPPING_TIMES = (0.25, 1.0)
"""Which give the velocities [s]."""

FOLLOWED = 2
"""Times the stopping time for which a motion is followed."""

SPRING_LENGTH = 1e4
"""Length over the stopping distance at which the spring pulls with the bound of friction: it hardly does."""

DISTANCE = Metric("distance", "", "Slip in the end over v² m / (2 μ λ_N).")
TIME = Metric("time", "", "When the block came within a thousandth of its way of where it is in the end, over T.")
DRIFT = Metric("drift", "µm/s", "Mean velocity of the slip in the last quarter of the time, at rest.")

NEAR = 1e-3
"""Of the way: with a constant deceleration it is reached at 1 − √0.001 of the stopping time."""


class Stop(Throw):
    """One case: a scale, and the time to rest."""

    def task(self, variant: Variant) -> BlockTask:
        """Give the task of a variant, with its coarsest step."""
        return self.thrown(variant, SPRING_LENGTH, FOLLOWED)

    def __str__(self) -> str:
        return f"{self.scale.title}, {self.velocity:.3g} m/s"


class StoppingDistance(BlockScenario[Stop]):
    """Sliding friction takes the velocity away at μ λ_N / m, and friction at rest keeps the block where it stops."""

    name = "stopping-distance"
    source = "Motion under a constant force, v² / (2 μ g) of a block under its own weight: any textbook of mechanics."
    metrics = (DISTANCE, TIME, DRIFT)
    cases = tuple(Stop(scale, time) for scale in SCALES for time in STOPPING_TIMES)

    def parameters(self) -> list[str]:
        """Give the steps; see `Scenario.parameters`."""
        return [f"steps of {THREE_STEPS}; followed for {FOLLOWED} times the time to rest"]

    def numbers(self, case: Stop, series: NamedNumbers) -> Mapping[Metric, Number]:
        """Read the slip over the stopping distance, at rows of the coarsest step."""
        slip = np.array(series["slip"])
        away = np.abs(slip - slip[-1]) > NEAR * abs(slip[-1])
        last = int(np.flatnonzero(away)[-1]) + 1 if np.any(away) else 0
        time = FOLLOWED * case.time / slip.size
        quarter = slip.size // 4
        return {
            DISTANCE: float(slip[-1]),
            TIME: (last + 1) * time / case.time,
            DRIFT: 1e6 * case.distance * float(slip[-1] - slip[-1 - quarter]) / (quarter * time),
        }

    def judged(self, variant: Variant, case: Stop, evaluator: Evaluator) -> list[Finding]:
        """Compare with the exact motion; the scheme's own error is allowed, but of the drift."""
        task = case.task(variant)
        read = self.read_beside(case, task, evaluator)
        rows = 2 * FOLLOWED / task.steps  # one of each reading
        drift, expected = (float(readings[DRIFT].judged) for readings in (read.own, read.expected))
        comparison = judged_at_one_step(DRIFT, drift, task, FOLLOWED * case.time / 4)
        return [
            read.finding(variant, case, DISTANCE, resolution=round_off(task) / case.distance),
            read.finding(variant, case, TIME, resolution=rows),
            Finding(variant, str(case), DRIFT, drift, expected, comparison),
        ]
