"""Questions about one block on a carrier.

Motions are compared as they are: two under one drive never drift apart, since friction with a given normal force is
monotone, as long as it is as large at rest as in motion.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from multibody_xval.engines.interface.tolerances import SINGLE
from multibody_xval.scenarios.catalogue.scenario import Quantity, Scenario, steps_a_row
from multibody_xval.scenarios.compute.motions import is_pressed
from multibody_xval.scenarios.model import AnyCase, Result, Run
from multibody_xval.scenarios.motions import Block, BlockMotion
from reference_lcp.chain.drives import StillBase, Vibration
from reference_lcp.defaults import FRICTION_COEFFICIENT

STANDARD_GRAVITY = 9.80665
"""g [m/s²]."""

TIME_STEP = 0.002
"""Time from row to row [s]: the default step of MuJoCo and a usual one of others, chosen for no scale of mass."""

STEPS_A_ROW = 4

ROUND_OFF = {"double": 2.0**-53, "single": SINGLE}
"""Largest rounding of a number, as a part of it."""

ROUNDINGS = 8
"""Of a position in a step: in forces, velocities and positions, and in as many substeps."""


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


def block_motion(case: AnyCase) -> BlockMotion:
    """Give the case, which is the motion of a block."""
    assert isinstance(case, BlockMotion), "the motion of a block"
    return case


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
    case = block_motion(run.case)
    largest = max(case.scale, abs(case.slip), abs(case.slip_velocity) * case.time)
    return ROUNDINGS * ROUND_OFF[run.config.capabilities.precision] * largest * math.sqrt(run.steps)


def compliance(run: Run) -> float:
    """Give the residual slip compliance that the preset states of the contact."""
    preset = run.config.preset
    return (preset.modulated() if is_pressed(run) else preset).residual_slip_compliance


def left_speed(run: Run) -> float:
    """Give the velocity that the residual slip compliance of a preset leaves to a block at rest [m/s]."""
    case = block_motion(run.case)
    inverse_mass = float(1 / case.chain.inner_mass[0] + 1 / case.chain.outer_mass[0])
    return compliance(run) * case.block.bound * inverse_mass * case.time / run.steps


def no_drift(over: float) -> Callable[[Run], float]:
    """Give what may be left of a velocity [µm/s] from two slips that are a part `over` of the motion apart."""
    return lambda run: 1e6 * (left_speed(run) + rounded(run) / (over * block_motion(run.case).time))


def no_way(run: Run) -> float:
    """Give what may be left of a way from one row to the next [µm]."""
    return 1e6 * (left_speed(run) * block_motion(run.case).time / block_motion(run.case).rows + rounded(run))


at_rest = partial(Quantity, exact=0.0, step_error=0.0, accuracy="drift")
"""A number of a block that friction should hold: whatever the step, nothing slips."""


def slips(result: Result) -> np.ndarray:
    """Give the slip of the block at the rows, over the displacement scale."""
    return np.array(result.series["slip"])


SPRING_LENGTH = 1e4
"""Length over the stopping distance at which the spring pulls with the bound of friction: it hardly does."""

NEAR = 1e-3
"""Of the way: with a constant deceleration it is reached at 1 − √0.001 of the stopping time."""

FOLLOWED = 2
"""Times the stopping time for which a motion is followed."""


def thrown(scale: Scale, time: float, spring_length: float = SPRING_LENGTH, followed: float = FOLLOWED) -> BlockMotion:
    """Give a block that is thrown over its carrier so fast that it comes to rest after a time [s].

    Its spring is so long over the distance, and it is followed for so long over the time.
    """
    velocity = scale.deceleration * time
    distance = velocity * time / 2
    return BlockMotion(
        block=scale.block(spring_length * distance), drive=StillBase(distance), slip_velocity=velocity,
        time=followed * time, rows=round(followed * time / TIME_STEP),
    )  # fmt: skip


def stopping_time(result: Result, _run: Run) -> float:
    """Give when the block came within `NEAR` of where it is in the end, over the time to rest."""
    slip = slips(result)
    away = np.flatnonzero(np.abs(slip - slip[-1]) > NEAR * abs(slip[-1]))
    return float((int(away[-1]) + 2 if away.size else 1) * FOLLOWED / slip.size)


def last_drift(result: Result, run: Run) -> float:
    """Give the mean velocity of the slip in the last quarter of the time [µm/s]."""
    case, slip = block_motion(run.case), slips(result)
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
            resolution=lambda run: rounded(run) / block_motion(run.case).scale,
            meaning="Slip in the end over v² m / (2 μ λ_N).",
        ),
        Quantity(
            name="time", unit="", read=stopping_time,
            resolution=lambda run: 2 * FOLLOWED / block_motion(run.case).rows,  # one row of each reading
            meaning="When the block came within a thousandth of its way of where it is in the end, over T.",
        ),
        at_rest(
            name="drift", unit="µm/s", read=last_drift, resolution=no_drift(1 / 8),
            meaning="Mean velocity of the slip in the last quarter of the time, at rest.",
        ),
    ),
    steps=steps_a_row(STEPS_A_ROW),
)  # fmt: skip
"""Sliding friction takes the velocity away at μ λ_N / m, and friction at rest keeps the block where it stops."""

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
    return 1e6 * (block_motion(run.case).slip - np.array([block_motion(run.case).slip, *(SIZE * slips(result))]))


def quarters(result: Result, run: Run) -> np.ndarray:
    """Give the drift in four quarters of the time [µm/s]."""
    return np.diff(way(result, run)[:: ROWS // 4]) / (HOLD_TIME / 4)


HELD = (
    at_rest(
        name="drift", unit="µm/s", resolution=no_drift(1 / 2),
        read=lambda result, run: float(np.mean(quarters(result, run)[2:])),
        meaning="Mean velocity of the slip in the second half of the time, as the load pulls.",
    ),
    at_rest(
        name="growth of drift", unit="µm/s", resolution=no_drift(1 / 8),
        read=lambda result, run: float(quarters(result, run)[3] - quarters(result, run)[1]),
        meaning="Drift in the last quarter less that in the second one.",
    ),
    at_rest(
        name="sag", unit="µm", resolution=no_way, read=lambda result, run: float(way(result, run)[1]),
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

SCENARIOS = (STATIC_HOLD, RATCHET, STOPPING_DISTANCE)
