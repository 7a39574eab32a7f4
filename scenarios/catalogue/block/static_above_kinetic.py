"""Static friction above kinetic friction: a block holds up to the one, and jumps under the other.

The carrier is free along the row, but for a weak spring, and a force that grows slowly takes it and the block along.
The block stays on it as long as its inertia F is below μ_s λ_N, then slides against its spring, k, and rests again.
With 1/m_r = 1/m + 1/M of block and carrier that jump is

    m_r s̈ = F(t) − μ_k λ_N − k s,        F = μ_s λ_N at first,

2 (μ_s − μ_k) λ_N / k long under a load that stays, and a tenth to a fifth longer as the load grows meanwhile.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.block.base import (
    SCALES,
    THREE_STEPS,
    TIME_STEP,
    BlockScenario,
    Scale,
    on_free_carrier,
    round_off,
)
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.result import NamedNumbers
from multibody_xval.scenarios.runs.transient_task import CARRIER_MASSES, BlockTask
from multibody_xval.scenarios.verdicts.finding import Finding, Metric
from multibody_xval.scenarios.verdicts.judge import Number
from reference_lcp.chain.drives import ShakingForce

STATIC_RATIOS = (1.2, 1.5)
"""μ_s / μ_k: a little above one, and as for dry steel."""

RISE_TIME = 1.0
"""Time in which the load reaches μ_s λ_N [s]."""

PEAK = 1.25
"""Largest load of the sine over μ_s λ_N: block and spring then rest where the jump leaves them."""

FOLLOWED = 1.4
"""Times the rise time for which a motion is followed; the load begins to fall after 1.7."""

JUMP_TIME = 0.1
"""π √(m_r / k) [s], the time of a jump under a load that stays; this one grows by 7 % of μ_s λ_N."""

FAST = 0.1
"""Of the largest velocity of the jump: from there on a slip counts, 3 ms after it has begun."""

BREAKAWAY = Metric("breakaway", "", "Load at which the block jumps over that at which it does in the exact motion.")
JUMP = Metric("jump", "", "Slip in the end over that of the exact motion.")


class Release(NamedTuple):
    """One case: a scale, and μ_s / μ_k."""

    scale: Scale
    static_ratio: float

    @property
    def frequency(self) -> float:
        """ω of the load F = F_max sin ωt [rad/s]."""
        return math.asin(1 / PEAK) / RISE_TIME

    @property
    def stiffness_length(self) -> float:
        """Length μ_k λ_N / k of the spring [m]."""
        reduced = self.scale.mass * CARRIER_MASSES / (1 + CARRIER_MASSES)
        return self.scale.bound / reduced * (JUMP_TIME / math.pi) ** 2

    @property
    def length(self) -> float:
        """2 (μ_s − μ_k) λ_N / k [m]."""
        return 2 * (self.static_ratio - 1) * self.stiffness_length

    @property
    def fastest(self) -> float:
        """Largest velocity of a jump under a load that stays [m/s]."""
        return self.length / 2 * math.pi / JUMP_TIME

    @property
    def travel(self) -> float:
        """By how much the force moves the carrier with the block [m]."""
        largest, phase = (
            PEAK * self.static_ratio * self.scale.bound / self.scale.mass,
            FOLLOWED * RISE_TIME * self.frequency,
        )
        return largest * (phase - math.sin(phase)) / self.frequency**2

    @property
    def two_steps(self) -> float:
        """By how much the load grows in two steps, over μ_s λ_N: a slip is seen at the end of one."""
        return self.load(RISE_TIME + TIME_STEP) - self.load(RISE_TIME - TIME_STEP)

    def load(self, time: float) -> float:
        """F at a time [s], over μ_s λ_N."""
        return PEAK * math.sin(self.frequency * time)

    def task(self, variant: Variant) -> BlockTask:
        """Give the task of a variant, with its coarsest step."""
        force = (1 + CARRIER_MASSES) * PEAK * self.static_ratio * self.scale.bound
        return BlockTask(
            variant=variant,
            block=on_free_carrier(self.scale.block(self.stiffness_length), FOLLOWED * RISE_TIME),
            base=ShakingForce(force, self.frequency, self.length),
            static_ratio=self.static_ratio,
            time_step=TIME_STEP,
            steps=round(FOLLOWED * RISE_TIME / TIME_STEP),
        )

    def __str__(self) -> str:
        return f"{self.scale.title}, {self.static_ratio:g}"


class StaticAboveKinetic(BlockScenario[Release]):
    """What is held by one coefficient of friction, and slides with another, sticks and slips in jumps."""

    name = "static-above-kinetic"
    source = "Coulomb's law with μ_s > μ_k: at rest up to μ_s λ_N, then m_r s̈ + k s = F − μ_k λ_N until it rests."
    metrics = (BREAKAWAY, JUMP)
    cases = tuple(Release(scale, ratio) for scale in SCALES for ratio in STATIC_RATIOS)

    def parameters(self) -> list[str]:
        """Give the ratios, the load and the steps; see `Scenario.parameters`."""
        ratios = ", ".join(f"{ratio:g}" for ratio in STATIC_RATIOS)
        return [
            f"μ_s / μ_k = {ratios}; the load reaches μ_s λ_N after {RISE_TIME:g} s, and is followed for "
            f"{FOLLOWED * RISE_TIME:g} s in steps of {THREE_STEPS}"
        ]

    def numbers(self, case: Release, series: NamedNumbers) -> Mapping[Metric, Number]:
        """Give the load at which a slip becomes fast, NaN if none does, and the slip in the end over the length."""
        fast = np.flatnonzero(np.abs(series["slip_velocity"]) > FAST * case.fastest)
        load = case.load((fast[0] + 1) * TIME_STEP) if fast.size else np.nan
        return {BREAKAWAY: float(load), JUMP: abs(float(series["slip"][-1]))}

    def judged(self, variant: Variant, case: Release, evaluator: Evaluator) -> list[Finding]:
        """Compare with the exact motion, at rows of the coarsest step; the scheme's own error is allowed.

        What breaks away two steps later does so under as much more load, and jumps as much farther over μ_s − μ_k.
        """
        task = case.task(variant)
        read = self.read_beside(case, task, evaluator).over_expected()
        above = (case.static_ratio - 1) / case.static_ratio
        farther = case.two_steps / above + round_off(task) * case.travel / case.length**2
        return [
            read.finding(variant, case, BREAKAWAY, resolution=case.two_steps, effect=above),
            read.finding(variant, case, JUMP, resolution=farther),
        ]
