"""Blocks under a load that friction holds, still or shaken."""

import math
from dataclasses import replace

import numpy as np

from multibody_xval.scenarios.cases.carrier_drives import Vibration
from multibody_xval.scenarios.cases.motions import BlockMotion
from multibody_xval.scenarios.catalogue.blocks.block import (
    SCALES,
    TIME_STEP,
    Scale,
    left_speed,
    no_drift,
    rounded,
    slips,
)
from multibody_xval.scenarios.catalogue.scenario import Scenario, at_rest, steps_a_row
from multibody_xval.scenarios.model import Result, Run
from reference_lcp.chain.drives import StillBase

HOLD_TIME = 10.0
"""How long the load lasts [s]."""

LENGTH = 1.0
"""Length at which the spring pulls with the bound of friction [m]: a drift of 1 mm/s takes off a hundredth of the load
in 10 s."""

SIZE = 0.1
"""Displacement scale [m]: that of a body one would hold."""

SHARE_OF_VIBRATION = 0.002
"""Amplitude of the vibration's acceleration times m, over the bound: with all that it makes of the carrier at first, a
load of 0.99 stays below the bound."""

VIBRATION_FREQUENCY = 2 * math.pi * 2.0
"""ω of the vibration [rad/s]."""

ROWS = 100
"""Rows that are kept of a motion."""


def held(scale: Scale, load: float, share: float = 0.0) -> BlockMotion:
    """Give a block under a part of the load that friction holds, on a base that vibrates with a share of it."""
    block = scale.block(LENGTH)
    swing = share * block.bound / (block.mass * VIBRATION_FREQUENCY**2)
    drive = Vibration(SIZE, swing, VIBRATION_FREQUENCY) if share else StillBase(SIZE)
    return BlockMotion(block=block, drive=drive, slip=load * LENGTH, time=HOLD_TIME, rows=ROWS)


def way(result: Result, run: Run) -> np.ndarray:
    """Give the slip as the load pulls, from the start on [µm], shape (rows + 1,)."""
    return 1e6 * (run.of(BlockMotion).slip - np.array([run.of(BlockMotion).slip, *(SIZE * slips(result))]))


def quarters(result: Result, run: Run) -> np.ndarray:
    """Give the drift in four quarters of the time [µm/s]."""
    return np.diff(way(result, run)[:: ROWS // 4]) / (HOLD_TIME / 4)


def no_way(run: Run) -> float:
    """Give what may be left of a way from one row to the next [µm]."""
    return 1e6 * (left_speed(run) * run.of(BlockMotion).time / run.of(BlockMotion).rows + rounded(run))


HELD = (
    at_rest(
        name="drift", unit="µm/s", resolution=no_drift(1 / 2), accuracy="drift",
        read=lambda result, run: float(np.mean(quarters(result, run)[2:])),
        meaning="Mean velocity of the slip in the second half of the time, as the load pulls.",
    ),
    at_rest(
        name="growth of drift", unit="µm/s", resolution=no_drift(1 / 8), accuracy="drift",
        read=lambda result, run: float(quarters(result, run)[3] - quarters(result, run)[1]),
        meaning="Drift in the last quarter less that in the second one.",
    ),
    at_rest(
        name="sag", unit="µm", resolution=no_way, accuracy="drift",
        read=lambda result, run: float(way(result, run)[1]),
        meaning="Slip in the first hundredth of the time, as the load pulls.",
    ),
)  # fmt: skip

STATIC_HOLD = Scenario(
    name="static-hold",
    question="Does a block under a load below the bound of friction stay where it is?",
    expects="no motion, but for what options of the preset leave to a contact, and round-off",
    source="Coulomb's law: |λ_T| < μ λ_N means no slip. As users ask it: google-deepmind/mujoco, issue 3328.",
    cases={
        f"{title}, load {load:g}{', shaken' if share else ''}": held(scale, load, share)
        for title, scale in SCALES.items()
        for share in (0.0, SHARE_OF_VIBRATION)
        for load in (0.1, 0.5, 0.9, 0.99)
    },
    quantities=HELD,
    steps=steps_a_row(round(HOLD_TIME / TIME_STEP) // ROWS),
)
"""Coulomb friction holds a load below its bound without any motion; regularised friction lets it drift."""

SWING = 0.2
"""Amplitude of the vibration's acceleration times m, over the bound, of a load that swings: one of a half stays below
the bound, whatever it makes of the carrier at first."""

RATCHET = replace(
    STATIC_HOLD,
    name="ratchet",
    question="Does a block under a load that swings below the bound of friction stay where it is?",
    source="Coulomb's law: |λ_T| < μ λ_N means no slip. Drift of bristles: Dupont, Armstrong and Hayward, American "
    "Control Conference 2000.",
    cases={f"{title}, load 0.5, shaken": held(scale, 0.5, SWING) for title, scale in SCALES.items()},
)
"""Coulomb friction holds a load that swings below its bound; bristles drift, a little with every swing."""

SCENARIOS = (STATIC_HOLD, RATCHET)
