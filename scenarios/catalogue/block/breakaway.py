"""Breakaway: a load that grows slowly, and the part of the bound of friction at which a block slips."""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.block.base import SCALES, TIME_STEP, BlockScenario, Scale, round_off
from multibody_xval.scenarios.catalogue.descriptions import REFERENCE_REFINEMENT
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.result import NamedNumbers
from multibody_xval.scenarios.runs.transient_task import BlockTask, TransientTask
from multibody_xval.scenarios.verdicts.finding import Finding, Metric
from multibody_xval.scenarios.verdicts.judge import Number
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE
from reference_lcp.chain.drives import GrowingAcceleration

RISE_TIME = 1.0
"""Time in which the load reaches the bound of friction [s]."""

FOLLOWED = 1.25
"""Times the rise time for which the load grows."""

TIME_STEPS = (2 * TIME_STEP, TIME_STEP, TIME_STEP / 2, TIME_STEP / 4)
"""Steps [s]: the coarsest that the carrier's own oscillation allows, and finer ones."""

LEAST_SPEED = 1e-3
"""Velocity of a slip that counts, over what friction alone would give in the rise time.

From the breakaway on, the velocity grows as J t² / 2: it is reached some 45 ms later, by the exact motion too.
"""

DELAY = math.sqrt(2 * LEAST_SPEED)
"""That time, over the rise time; an error of the velocity, over that which counts, moves it by half as much."""

SPRING_LENGTH = 1e4
"""Length of the spring at which it pulls with the bound of friction, over the way of the base: it hardly does."""

FRACTION = Metric("breakaway", "", "Load at the slip over that at which the reference slips, in finer steps.")


class Pull(NamedTuple):
    """One case: a scale, and a step."""

    scale: Scale
    time_step: float

    @property
    def base(self) -> GrowingAcceleration:
        """The acceleration of the base, with which m a reaches the bound after `RISE_TIME`."""
        return GrowingAcceleration(self.scale.deceleration * RISE_TIME**2 / 6, RISE_TIME)

    @property
    def speed(self) -> float:
        """Velocity that friction alone gives in the rise time [m/s]."""
        return self.scale.deceleration * RISE_TIME

    def task(self, variant: Variant) -> BlockTask:
        """Give the task of a variant."""
        base = self.base
        return BlockTask(
            variant=variant,
            block=self.scale.block(SPRING_LENGTH * base.amplitude),
            base=base,
            time_step=self.time_step,
            steps=round(FOLLOWED * RISE_TIME / self.time_step),
        )

    def __str__(self) -> str:
        return f"{self.scale.title}, {1e3 * self.time_step:g} ms"


class Breakaway(BlockScenario[Pull]):
    """Dry friction holds up to its bound and not beyond; a regularised one slips from the first load on."""

    name = "breakaway"
    source = "Coulomb's law: a contact slips where the load passes μ λ_N; a tilting table's angle is arctan μ."
    metrics = (FRACTION,)
    cases = tuple(Pull(scale, step) for scale in SCALES for step in TIME_STEPS)

    def parameters(self) -> list[str]:
        """Give the load, and what counts as a slip; see `Scenario.parameters`."""
        return [
            f"the base's acceleration grows in proportion to time, until m a = {FOLLOWED:g} μ λ_N after "
            f"{FOLLOWED * RISE_TIME:g} s; a slip counts from {LEAST_SPEED:g} μ λ_N / m · {RISE_TIME:g} s on"
        ]

    def baseline(self, case: Pull) -> list[TransientTask]:
        """Give the task of the reference in finer steps."""
        return [case.task(REFERENCE).refined(REFERENCE_REFINEMENT)]

    def simulated(self, task: TransientTask) -> list[TransientTask]:
        """Give the task alone: its step is that of the case."""
        return [task]

    def numbers(self, case: Pull, series: NamedNumbers) -> Mapping[Metric, Number]:
        """Read when the block slips."""
        return {FRACTION: slip_time(case, series["slip_velocity"])}

    def judged(self, variant: Variant, case: Pull, evaluator: Evaluator) -> list[Finding]:
        """Compare with the reference in finer steps: within two steps, for a slip is seen at its end."""
        task = case.task(variant)
        read = self.read_beside(case, task, evaluator, scheme=False).over_expected()
        late = round_off(task) / RISE_TIME / (LEAST_SPEED * case.speed) * DELAY / 2 + 2 * task.time_step / RISE_TIME
        return [read.finding(variant, case, FRACTION, resolution=late)]


def slip_time(pull: Pull, velocity: Sequence[float]) -> float:
    """Give when the slip becomes as fast as counts [s]; NaN if it never does."""
    fast = np.flatnonzero(np.abs(velocity) > LEAST_SPEED * pull.speed)
    return float((fast[0] + 1) * pull.time_step) if fast.size else np.nan
