"""What the questions about one block share: its scales, its step, and what is left open of a slip.

Motions are compared as they are: two under one drive never drift apart, since friction with a given normal force is
monotone, as long as it is as large at rest as in motion.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from multibody_xval.engines.interface.tolerances import SINGLE
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.motion import Case, MotionScenario
from multibody_xval.scenarios.runs.transient_task import Block, BlockTask
from multibody_xval.scenarios.verdicts.finding import Comparison, Metric
from multibody_xval.scenarios.verdicts.judge import Steps, judge
from reference_lcp.chain.drives import StillBase
from reference_lcp.defaults import FRICTION_COEFFICIENT
from reference_lcp.steady.error_bar import REFINEMENTS

STANDARD_GRAVITY = 9.80665
"""g [m/s²]."""

TIME_STEP = 0.002
"""dt [s], the default of MuJoCo and a usual one of others; none is chosen for a scale of mass or force."""

THREE_STEPS = f"{', '.join(f'{1e3 * TIME_STEP / factor:g}' for factor in REFINEMENTS)} ms"

ROUND_OFF = {"double": 2.0**-53, "single": SINGLE}
"""Largest rounding of a number, as a part of it."""

ROUNDINGS = 8
"""Of a position in a step: in forces, velocities and positions, and in as many substeps."""

CARRIER_PHASE = 1e-3
"""ω_c times the length of a motion [rad]: the spring of a carrier that is free along the row, but for that spring,
changes what it does by 5e-7 of its way."""


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

    @property
    def bound(self) -> float:
        """μ λ_N [N]."""
        return FRICTION_COEFFICIENT * self.normal_force

    @property
    def deceleration(self) -> float:
        """μ λ_N / m [m/s²]."""
        return self.bound / self.mass

    def block(self, stiffness_length: float) -> Block:
        """Give the block, with a spring that is as strong as friction once it is this long [m]."""
        return Block(mass=self.mass, normal_force=self.normal_force, stiffness=self.bound / stiffness_length)


SCALES = (Scale("1 g", 1e-3), Scale("1 kg", 1.0), Scale("1 t under 10 t", 1e3, 10.0))


@dataclass(frozen=True)
class Throw:
    """A block that is thrown over its carrier so fast that it comes to rest after a time."""

    scale: Scale
    time: float
    """T = v m / (μ λ_N) [s]."""

    @property
    def velocity(self) -> float:
        """Velocity at first [m/s]."""
        return self.scale.deceleration * self.time

    @property
    def distance(self) -> float:
        """v² m / (2 μ λ_N) [m]."""
        return self.velocity * self.time / 2

    def thrown(self, variant: Variant, spring_length: float, followed: float, direction: float = 0.0) -> BlockTask:
        """Give the task of a variant: the length of the spring over the distance, and of the motion over the time."""
        return BlockTask(
            variant=variant,
            block=self.scale.block(spring_length * self.distance),
            base=StillBase(self.distance),
            slip_velocity=self.velocity,
            direction=direction,
            time_step=TIME_STEP,
            steps=round(followed * self.time / TIME_STEP),
        )


class BlockScenario(MotionScenario[Case]):
    """A question about one block; a case is one scale with one value of what is varied."""

    law_series = "slip"


def on_free_carrier(block: Block, time: float) -> Block:
    """Give a block whose carrier is free along the row, but for a weak spring, in a motion of this length [s]."""
    return replace(block, carrier_frequency=CARRIER_PHASE / time, carrier_damping=0.0)


def round_off(task: BlockTask) -> float:
    """Give by how much roundings of positions move a slip over a motion [m]: they add up as the root of their number.

    The largest position is that of the base, or the slip at first.
    """
    base = task.base.displacement_scale(task.chain)
    largest = max(base, abs(task.slip), abs(task.slip_velocity) * task.steps * task.time_step)
    return ROUNDINGS * ROUND_OFF[task.variant.capabilities.precision] * largest * float(np.sqrt(task.steps))


def stated_compliance(task: BlockTask) -> float:
    """Give the residual slip compliance that the preset states for the contact of a task."""
    preset = task.variant.preset
    return (preset if task.lane().preload is None else preset.modulated()).residual_slip_compliance


def judged_at_one_step(metric: Metric, value: float, task: BlockTask, time: float) -> Comparison:
    """Compare a slip [µm], or a velocity [µm/s] from two that are `time` [s] apart, with none at all.

    Whatever the step, Coulomb friction lets nothing slip: an error that gets smaller with the step is none that is
    allowed. Round-off is, and the residual slip compliance that the preset states: that part of the velocity which
    friction takes away in a step.
    """
    inverse_mass = float(1 / task.chain.inner_mass[0] + 1 / task.chain.outer_mass[0])
    speed = stated_compliance(task) * task.block.bound * inverse_mass * task.time_step
    if math.isinf(time):
        allowed, per_amplitude = speed * task.every * task.time_step + round_off(task), 1.0
    else:
        allowed, per_amplitude = speed + round_off(task) / time, 1 / time
    comparison = judge(metric, Steps({1: value}), 0.0, resolution=1e6 * allowed)
    return replace(comparison, per_amplitude=1e6 * per_amplitude * task.base.displacement_scale(task.chain))
