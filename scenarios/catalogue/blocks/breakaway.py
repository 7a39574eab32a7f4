"""Breakaway: a load that grows slowly, and the part of the bound of friction at which a block slips."""

import numpy as np

from multibody_xval.scenarios.cases.carrier_drives import GrowingAcceleration
from multibody_xval.scenarios.cases.motions import CARRIER_DAMPING, CARRIER_FREQUENCY, CARRIER_MASSES, BlockMotion
from multibody_xval.scenarios.catalogue.blocks.block import SCALES, TIME_STEP, Scale, rounded
from multibody_xval.scenarios.catalogue.blocks.thrown import SPRING_LENGTH
from multibody_xval.scenarios.catalogue.scenario import Quantity, Scenario, steps_a_row
from multibody_xval.scenarios.model import Result, Run
from reference_lcp.validation import FloatArray

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

DELAY = (2 * LEAST_SPEED) ** 0.5
"""That time, over the rise time; an error of the velocity, over that which counts, moves it by half as much."""


def pulled(scale: Scale, time_step: float) -> BlockMotion:
    """Give a block on a base whose acceleration grows in proportion to time, until m a passes the bound."""
    base = GrowingAcceleration(scale.deceleration * RISE_TIME**2 / 6, RISE_TIME)
    rows = round(FOLLOWED * RISE_TIME / time_step)
    return BlockMotion(block=scale.block(SPRING_LENGTH * base.amplitude), drive=base, time=rows * time_step, rows=rows)


def speed(case: BlockMotion) -> float:
    """Give the velocity that friction alone gives in the rise time [m/s]."""
    return case.block.bound / case.block.mass * RISE_TIME


def first_fast(case: BlockMotion, velocity: FloatArray, fast: float) -> float:
    """Give the time [s] of the first row at which a slip is faster than that; NaN if none is."""
    rows = np.flatnonzero(np.abs(velocity) > fast)
    return float(case.row_times[rows[0]]) if rows.size else float("nan")


def slip_time(result: Result, run: Run) -> float:
    """Give when the slip becomes as fast as counts [s]; NaN if it never does."""
    case = run.of(BlockMotion)
    return first_fast(case, np.array(result.series["slip_velocity"]), LEAST_SPEED * speed(case))


def exact_velocity(case: BlockMotion) -> FloatArray:
    """Give the velocity of the slip by Coulomb's law [m/s], shape (rows,).

    Until the breakaway the carrier is behind the base by (M + m) a / k_c. From then on friction no longer grows: the
    slip is J t² / 2 fast, and the carrier gains the velocity m J / k_c on top, by a damped oscillation.
    """
    time = np.maximum(case.row_times - RISE_TIME, 0.0)
    turn = np.sqrt(1 - CARRIER_DAMPING**2)
    phase = CARRIER_FREQUENCY * turn * time
    swing = np.exp(-CARRIER_DAMPING * CARRIER_FREQUENCY * time) * (
        np.cos(phase) + CARRIER_DAMPING / turn * np.sin(phase)
    )
    gained = (1 - swing) / (CARRIER_MASSES * CARRIER_FREQUENCY**2)
    velocity: FloatArray = speed(case) / RISE_TIME**2 * (time**2 / 2 + gained)
    return velocity


def exact_slip_time(case: BlockMotion) -> float:
    """Give when the slip becomes as fast as counts by Coulomb's law [s], at a row as well."""
    return first_fast(case, exact_velocity(case), LEAST_SPEED * speed(case))


def late(run: Run) -> float:
    """Give how late a slip may be seen, over the time of breakaway: two steps, for it is seen at the end of one."""
    case = run.of(BlockMotion)
    return rounded(run) / RISE_TIME / (LEAST_SPEED * speed(case)) * DELAY / 2 + 2 * case.time / run.steps / RISE_TIME


BREAKAWAY = Scenario(
    name="breakaway",
    question="Under a load that grows slowly, at which part of its bound does a contact begin to slip?",
    expects="Coulomb's law in closed form, at the rows of the motion; allowed: two steps",
    source="Coulomb's law: a contact slips where the load passes μ λ_N; a tilting table's angle is arctan μ.",
    cases={
        f"{title}, {1e3 * step:g} ms": pulled(scale, step) for title, scale in SCALES.items() for step in TIME_STEPS
    },
    quantities=(
        Quantity(
            name="breakaway", unit="", read=slip_time, exact=exact_slip_time, step_error=0.0, resolution=late,
            over_exact=True, meaning="Load at the slip over that at which friction lets go.",
        ),
    ),
    steps=steps_a_row(),
    details=(
        f"The base's acceleration grows in proportion to time, until m a = {FOLLOWED:g} μ λ_N after "
        f"{FOLLOWED * RISE_TIME:g} s.",
        f"A slip counts from {LEAST_SPEED:g} μ λ_N / m · {RISE_TIME:g} s on.",
    ),
)  # fmt: skip
"""Dry friction holds up to its bound and not beyond; a regularised one slips from the first load on."""

SCENARIOS = (BREAKAWAY,)
