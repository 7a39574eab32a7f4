"""Static hold: a block under a constant load below the bound of friction stays where it is."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.block.base import SCALES, TIME_STEP, BlockScenario, Scale, judged_at_one_step
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.result import NamedNumbers
from multibody_xval.scenarios.runs.transient_task import BlockTask, TransientTask
from multibody_xval.scenarios.verdicts.finding import Finding, Metric
from multibody_xval.scenarios.verdicts.judge import Number
from reference_lcp.chain.drives import StillBase, Vibration

HOLD_TIME = 10.0
"""How long the load lasts [s]."""

LOADS = (0.1, 0.5, 0.9, 0.99)
"""Of the bound of friction."""

LENGTH = 1.0
"""Length at which the spring pulls with the bound of friction [m]: a creep of 1 mm/s takes off a hundredth of the load
in 10 s."""

SIZE = 0.1
"""Displacement scale [m]: that of a body one would hold."""

SHARE_OF_VIBRATION = 0.002
"""Amplitude of the vibration's acceleration times m, over the bound: with all that it makes of the carrier at first, a
load of 0.99 stays below the bound."""

SWING = 0.2
"""The same of a load that swings: one of a half stays below the bound, whatever it makes of the carrier at first."""

VIBRATION_FREQUENCY = 2 * math.pi * 2.0
"""ω of the vibration [rad/s]."""

ROWS = 100
"""Rows that are kept of a motion."""

CREEP = Metric("creep", "µm/s", "Mean velocity of the slip in the second half of the time, as the load pulls.")
GROWTH = Metric("growth of creep", "µm/s", "Creep in the last quarter less that in the second one.")
SAG = Metric("sag", "µm", "Slip in the first hundredth of the time, as the load pulls.")


READ_OVER = {CREEP: HOLD_TIME / 2, GROWTH: HOLD_TIME / 8, SAG: math.inf}
"""Time over which two slips make a velocity [s]; of a difference of two velocities, half of it."""


class Hold(NamedTuple):
    """One case: a load, with or without a vibration."""

    scale: Scale
    load: float
    share: float = 0.0
    """Of the vibration, see `SHARE_OF_VIBRATION`."""

    def task(self, variant: Variant) -> BlockTask:
        """Give the task of a variant."""
        block = self.scale.block(LENGTH)
        swing = self.share * block.bound / (block.mass * VIBRATION_FREQUENCY**2)
        steps = round(HOLD_TIME / TIME_STEP)
        return BlockTask(
            variant=variant,
            block=block,
            base=Vibration(SIZE, swing, VIBRATION_FREQUENCY) if self.share else StillBase(SIZE),
            slip=self.load * LENGTH,
            time_step=TIME_STEP,
            steps=steps,
            every=steps // ROWS,
        )

    def __str__(self) -> str:
        shaken = ", shaken" if self.share else ""
        return f"{self.scale.title}, load {self.load:g}{shaken}"


class StaticHold(BlockScenario[Hold]):
    """Coulomb friction holds a load below its bound without any motion; regularised friction lets it creep."""

    name = "static-hold"
    source = "Coulomb's law: |λ_T| < μ λ_N means no slip. As users ask it: google-deepmind/mujoco, issue 3328."
    metrics = (CREEP, GROWTH, SAG)
    cases = tuple(Hold(scale, load, share) for scale in SCALES for share in (0.0, SHARE_OF_VIBRATION) for load in LOADS)

    def parameters(self) -> list[str]:
        """Give load, vibration and steps; see `Scenario.parameters`."""
        return [
            f"a spring, stretched to a part of the {LENGTH:g} m at which it pulls with μ λ_N, for {HOLD_TIME:g} s in "
            f"steps of {1e3 * TIME_STEP:g} ms",
            f"shaken: the base vibrates with m a = {max(case.share for case in self.cases):g} μ λ_N at "
            f"{VIBRATION_FREQUENCY / (2 * math.pi):g} Hz",
        ]

    def baseline(self, case: Hold) -> list[TransientTask]:
        """Give none: nothing slips."""
        return []

    def simulated(self, task: TransientTask) -> list[TransientTask]:
        """Give the task alone: whatever its step, nothing slips."""
        return [task]

    def numbers(self, case: Hold, series: NamedNumbers) -> Mapping[Metric, Number]:
        """Read the creep of four quarters of the time, and the slip that comes before."""
        slip = np.array([case.load * LENGTH, *(SIZE * np.array(series["slip"]))])
        creep = -1e6 * np.diff(slip[:: ROWS // 4]) / (HOLD_TIME / 4)
        return {
            CREEP: float(np.mean(creep[2:])),
            GROWTH: float(creep[3] - creep[1]),
            SAG: -1e6 * float(slip[1] - slip[0]),
        }

    def judged(self, variant: Variant, case: Hold, evaluator: Evaluator) -> list[Finding]:
        """Compare creep with none; a preset's own residual slip compliance and round-off are allowed."""
        task = case.task(variant)
        read = self.read_beside(case, task, evaluator, scheme=False)
        values = {metric: float(own.judged) for metric, own in read.own.items()}
        return [
            Finding(variant, str(case), metric, value, 0.0, judged_at_one_step(metric, value, task, READ_OVER[metric]))
            for metric, value in values.items()
        ]


class Ratchet(StaticHold):
    """Coulomb friction holds a load that swings below its bound; bristles creep, a little with every swing."""

    name = "ratchet"
    source = (
        "Coulomb's law, as above. Drift of bristles: Dupont, Armstrong and Hayward, American Control Conference 2000."
    )
    cases = tuple(Hold(scale, 0.5, SWING) for scale in SCALES)
