"""Blocks that are thrown over their carrier: how far they slide, and whether they stay where they stop."""

import numpy as np

from multibody_xval.scenarios.cases.motions import BlockMotion
from multibody_xval.scenarios.catalogue.blocks.block import (
    SCALES,
    STEPS_A_ROW,
    TIME_STEP,
    Scale,
    no_drift,
    rounded,
    slips,
)
from multibody_xval.scenarios.catalogue.scenario import Quantity, Scenario, at_rest, steps_a_row
from multibody_xval.scenarios.model import Result, Run
from reference_lcp.chain.drives import StillBase

SPRING_LENGTH = 1e4
"""Length over the stopping distance at which the spring pulls with the bound of friction: it hardly does."""

NEAR = 1e-3
"""Of the way: with a constant deceleration it is reached at 1 − √0.001 of the stopping time."""

FOLLOWED = 2
"""Times the stopping time for which a motion is followed."""


def thrown(scale: Scale, time: float) -> BlockMotion:
    """Give a block that is thrown over its carrier so fast that it comes to rest after a time [s]."""
    velocity = scale.deceleration * time
    distance = velocity * time / 2
    return BlockMotion(
        block=scale.block(SPRING_LENGTH * distance), drive=StillBase(distance), slip_velocity=velocity,
        time=FOLLOWED * time, rows=round(FOLLOWED * time / TIME_STEP),
    )  # fmt: skip


def stopping_time(result: Result, _run: Run) -> float:
    """Give when the block came within `NEAR` of where it is in the end, over the time to rest."""
    slip = slips(result)
    away = np.flatnonzero(np.abs(slip - slip[-1]) > NEAR * abs(slip[-1]))
    return float((int(away[-1]) + 2 if away.size else 1) * FOLLOWED / slip.size)


def last_drift(result: Result, run: Run) -> float:
    """Give the mean velocity of the slip in the last quarter of the time [µm/s]."""
    case, slip = run.of(BlockMotion), slips(result)
    quarter = slip.size // 4
    return 1e6 * case.scale * float(slip[-1] - slip[-1 - quarter]) / (quarter * case.time / case.rows)


STOPPING_DISTANCE = Scenario(
    name="stopping-distance",
    question="How far does a block slide that is thrown over its carrier, and does it stay where it stops?",
    expects="the event-driven motion, exact to round-off; of presets that share the scheme the reference at equal "
    "steps; no drift, but for what options of the preset leave",
    source="Motion under a constant force, v² / (2 μ g) of a block under its own weight: any textbook of mechanics.",
    cases={
        f"{title}, {scale.deceleration * time:.3g} m/s": thrown(scale, time)
        for title, scale in SCALES.items()
        for time in (0.25, 1.0)
    },
    quantities=(
        Quantity(
            name="distance", unit="", read=lambda result, _run: float(slips(result)[-1]), accuracy="transmittance",
            resolution=lambda run: rounded(run) / run.of(BlockMotion).scale,
            meaning="Slip in the end over v² m / (2 μ λ_N).",
        ),
        Quantity(
            name="time", unit="", read=stopping_time,
            resolution=lambda run: 2 * FOLLOWED / run.of(BlockMotion).rows,  # one row of each reading
            meaning="When the block came within a thousandth of its way of where it is in the end, over T.",
        ),
        at_rest(
            name="drift", unit="µm/s", read=last_drift, resolution=no_drift(1 / 8), accuracy="drift",
            meaning="Mean velocity of the slip in the last quarter of the time, at rest.",
        ),
    ),
    steps=steps_a_row(STEPS_A_ROW),
)  # fmt: skip
"""Sliding friction takes the velocity away at μ λ_N / m, and friction at rest keeps the block where it stops."""

SCENARIOS = (STOPPING_DISTANCE,)
