"""Direction: the bound of friction along a row that is turned in the plane of its contact."""

import math
from dataclasses import replace

from multibody_xval.scenarios.cases.motions import BlockMotion
from multibody_xval.scenarios.catalogue.blocks.block import SCALES, STEPS_A_ROW, Scale, compliance
from multibody_xval.scenarios.catalogue.blocks.thrown import thrown
from multibody_xval.scenarios.catalogue.scenario import Quantity, Scenario, round_off, steps_a_row
from multibody_xval.scenarios.model import Run

ANGLES = (0, 15, 30, 45, 60, 75, 90)
"""By which the row is turned [°]: pyramids of four faces are seen at their edges and at their faces."""

STOPPING_TIMES = (0.1, 1.0)
"""A fast and a slow slip, since some engines have a velocity of their own [s]."""

PART = 0.2
"""Of the velocity that friction takes off: sideways forces of a pyramid turn the slip by a tenth of that at most."""

SPRING_LENGTH = 1e6
"""Length over the stopping distance at which the spring pulls with the bound of friction: it hardly does."""

LEFT_BY_SPRINGS = 1e-5
"""Of the bound: what the springs of the chain make of it. Friction that is off by 40 % moves the block 1e-6 of the
spring's length less, and all that it does to the carrier is in proportion."""


def slid(scale: Scale, time: float, angle: float) -> BlockMotion:
    """Give a block that slides until friction has taken a part of its velocity, in a row turned by an angle [°]."""
    return replace(thrown(scale, time, SPRING_LENGTH, PART), direction=math.radians(angle))


def left_open(run: Run) -> float:
    """Give what springs, roundings of velocities and the stated residual slip compliance leave open of the bound.

    The velocity falls by equal parts, so that its roundings are equal too, and add up as the number of steps.
    """
    rounding = round_off(run) * run.steps / PART
    return LEFT_BY_SPRINGS + rounding + compliance(run)


DIRECTION = Scenario(
    name="direction",
    question="Does the bound of friction depend on the direction in which a block slides over its contact?",
    expects="the event-driven motion, exact to round-off, the same in all directions; of presets that share the scheme "
    "the reference at equal steps",
    source="Coulomb's law: |λ_T| = μ λ_N against the slip. As users ask it: RobotLocomotion/drake, issue 18932.",
    cases={
        f"{title}, {scale.deceleration * time:.3g} m/s, {angle}°": slid(scale, time, angle)
        for title, scale in SCALES.items()
        for time in STOPPING_TIMES
        for angle in ANGLES
    },
    quantities=(
        Quantity(
            name="bound", unit="", over_exact=True, resolution=left_open, per_amplitude=0.0, accuracy="transmittance",
            read=lambda result, run: run.of(BlockMotion).slip_velocity - result.series["slip_velocity"][-1],
            meaning="Loss of slip velocity over that of the exact motion: mean friction over μ λ_N.",
        ),
    ),
    steps=steps_a_row(STEPS_A_ROW),
    details=(f"Followed until friction has taken {PART:g} of the velocity.",),
)  # fmt: skip
"""Coulomb's cone is round; pyramids have edges, by which friction is too large, or faces, by which too small."""

SCENARIOS = (DIRECTION,)
