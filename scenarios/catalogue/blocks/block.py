"""What questions about one block on a carrier share.

Motions are compared as they are: two under one drive never drift apart, since friction with a given normal force is
monotone, as long as it is as large at rest as in motion.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from multibody_xval.scenarios.cases.motions import Block, BlockMotion
from multibody_xval.scenarios.catalogue.scenario import ROUNDINGS, round_off
from multibody_xval.scenarios.compute.motions import is_pressed
from multibody_xval.scenarios.model import Result, Run
from reference_lcp.defaults import FRICTION_COEFFICIENT

STANDARD_GRAVITY = 9.80665
"""g [m/s²]."""

TIME_STEP = 0.002
"""Time from row to row [s]: the default step of MuJoCo and a usual one of others, chosen for no scale of mass."""

STEPS_A_ROW = 4


@dataclass(frozen=True)
class Scale:
    """Mass of a block [kg], and the force on it in weights."""

    mass: float
    weights: float = 1.0

    @property
    def deceleration(self) -> float:
        """μ λ_N / m [m/s²]."""
        return FRICTION_COEFFICIENT * self.weights * STANDARD_GRAVITY

    def block(self, length: float) -> Block:
        """Give the block, with a spring that is as strong as friction once it is this long [m]."""
        force = self.weights * self.mass * STANDARD_GRAVITY
        return Block(mass=self.mass, normal_force=force, stiffness=FRICTION_COEFFICIENT * force / length)


SCALES = {"1 g": Scale(1e-3), "1 kg": Scale(1.0), "1 t under 10 t": Scale(1e3, 10.0)}


CARRIER_PHASE = 1e-3
"""ω_c times the length of a motion [rad]: the spring of a carrier that is free along the row, but for that spring,
changes what it does by 5e-7 of its way."""


def on_free_carrier(block: Block, time: float) -> Block:
    """Give a block whose carrier is free along the row, but for a weak spring, in a motion of this length [s]."""
    return replace(block, carrier_frequency=CARRIER_PHASE / time, carrier_damping=0.0)


def rounded(run: Run) -> float:
    """Give by how much roundings of positions move a slip over a motion [m]: they add up as the root of their number.

    The largest position is that of the base, or the slip at first.
    """
    case = run.of(BlockMotion)
    largest = max(case.scale, abs(case.slip), abs(case.slip_velocity) * case.time)
    return ROUNDINGS * round_off(run) * largest * math.sqrt(run.steps)


def compliance(run: Run) -> float:
    """Give the residual slip compliance that the preset states of the contact."""
    preset = run.config.preset
    return (preset.modulated() if is_pressed(run) else preset).residual_slip_compliance


def left_speed(run: Run) -> float:
    """Give the velocity that the residual slip compliance of a preset leaves to a block at rest [m/s]."""
    case = run.of(BlockMotion)
    inverse_mass = float(1 / case.chain.inner_mass[0] + 1 / case.chain.outer_mass[0])
    return compliance(run) * case.block.bound * inverse_mass * case.time / run.steps


def no_drift(over: float) -> Callable[[Run], float]:
    """Give what may be left of a velocity [µm/s] from two slips that are a part `over` of the motion apart."""
    return lambda run: 1e6 * (left_speed(run) + rounded(run) / (over * run.of(BlockMotion).time))


def slips(result: Result) -> np.ndarray:
    """Give the slip of the block at the rows, over the displacement scale."""
    return np.array(result.series["slip"])
