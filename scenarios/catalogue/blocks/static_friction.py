"""Static friction above kinetic friction: a block holds up to the one, and jumps under the other.

The carrier is free along the row, but for a weak spring, and a force that grows slowly takes it and the block along.
The block stays on it as long as its inertia F is below μ_s λ_N, then slides against its spring, k, and rests again.
With 1/m_r = 1/m + 1/M of block and carrier that jump is

    m_r s̈ = F(t) − μ_k λ_N − k s,        F = μ_s λ_N at first,

2 (μ_s − μ_k) λ_N / k long under a load that stays, and a tenth to a fifth longer as the load grows meanwhile.
"""

import math

import numpy as np

from multibody_xval.scenarios.cases.motions import CARRIER_MASSES, BlockMotion
from multibody_xval.scenarios.catalogue.blocks.block import (
    SCALES,
    STEPS_A_ROW,
    TIME_STEP,
    Scale,
    on_free_carrier,
    rounded,
    slips,
)
from multibody_xval.scenarios.catalogue.blocks.breakaway import first_fast
from multibody_xval.scenarios.catalogue.scenario import Number, Quantity, Scenario, steps_a_row
from multibody_xval.scenarios.model import Result, Run
from reference_lcp.chain.drives import HarmonicForce

STATIC_RATIOS = (1.2, 1.5)
"""μ_s / μ_k: a little above one, and as for dry steel."""

RISE_TIME = 1.0
"""Time in which the load reaches μ_s λ_N [s]."""

PEAK = 1.25
"""Largest load of the sine over μ_s λ_N: block and spring then rest where the jump leaves them."""

FREQUENCY = math.asin(1 / PEAK) / RISE_TIME
"""ω of the load F = F_max sin ωt [rad/s]."""

FOLLOWED = 1.4
"""Time for which a motion is followed [s]; the load begins to fall after 1.7 s."""

JUMP_TIME = 0.1
"""π √(m_r / k) [s], the time of a jump under a load that stays; this one grows by 7 % of μ_s λ_N."""

FAST = 0.1
"""Of the largest velocity of the jump: from there on a slip counts, 3 ms after it has begun."""


def load(time: float) -> float:
    """Give F at a time [s], over μ_s λ_N."""
    return PEAK * math.sin(FREQUENCY * time)


TWO_STEPS = load(RISE_TIME + TIME_STEP) - load(RISE_TIME - TIME_STEP)
"""By how much the load grows from one row to the next but one, over μ_s λ_N: a slip is seen at the end of a step."""


def released(scale: Scale, static_ratio: float) -> BlockMotion:
    """Give a block under a load that passes its static friction; displacements are over 2 (μ_s − μ_k) λ_N / k."""
    reduced = CARRIER_MASSES / (1 + CARRIER_MASSES)
    spring_length = scale.deceleration / reduced * (JUMP_TIME / math.pi) ** 2  # μ_k λ_N / k [m]
    block = on_free_carrier(scale.block(spring_length), FOLLOWED)
    force = (1 + CARRIER_MASSES) * PEAK * static_ratio * block.bound
    return BlockMotion(
        block=block, drive=HarmonicForce(force, FREQUENCY, 2 * (static_ratio - 1) * spring_length),
        static_ratio=static_ratio, time=FOLLOWED, rows=round(FOLLOWED / TIME_STEP),
    )  # fmt: skip


def fast(case: BlockMotion) -> float:
    """Give the velocity from which on a slip counts [m/s]."""
    return FAST * (case.scale / 2 * math.pi / JUMP_TIME)


def breakaway_load(result: Result, run: Run) -> float:
    """Give the load at which a slip becomes fast, over μ_s λ_N; NaN if none does."""
    case = run.of(BlockMotion)
    return load(first_fast(case, np.array(result.series["slip_velocity"]), fast(case)))


def jump(result: Result, _run: Run) -> float:
    """Give the slip in the end, over the displacement scale."""
    return abs(float(slips(result)[-1]))


def above(case: BlockMotion, _exact: Number = 1.0) -> float:
    """Give (μ_s − μ_k) / μ_s: what an engine with one coefficient breaks away too early."""
    return (case.static_ratio - 1) / case.static_ratio


def farther(run: Run) -> float:
    """Give by how much farther a block jumps that breaks away two steps late, and with the roundings of its way."""
    case = run.of(BlockMotion)
    phase = FOLLOWED * FREQUENCY
    travel = PEAK * case.static_ratio * case.block.bound / case.block.mass * (phase - math.sin(phase)) / FREQUENCY**2
    return TWO_STEPS / above(case) + rounded(run) * travel / case.scale**2


STATIC_ABOVE_KINETIC = Scenario(
    name="static-above-kinetic",
    question="Does a contact hold more at rest than in motion, and how far does the block jump when it slips?",
    expects="the event-driven motion, exact to round-off: μ_s λ_N, then 2 (μ_s − μ_k) λ_N / k and what the load grows; "
    "allowed: two rows of a breakaway, and what they change of the jump",
    source="Coulomb's law with μ_s > μ_k: at rest up to μ_s λ_N, then m_r s̈ + k s = F − μ_k λ_N until it rests.",
    cases={f"{title}, {ratio:g}": released(scale, ratio) for title, scale in SCALES.items() for ratio in STATIC_RATIOS},
    quantities=(
        Quantity(
            name="breakaway", unit="", read=breakaway_load, over_exact=True, step_error=0.0,
            resolution=TWO_STEPS, effect=above, accuracy="transmittance",
            meaning="Load at which the block jumps over that at which it does in the exact motion.",
        ),
        Quantity(
            name="jump", unit="", read=jump, over_exact=True, step_error=0.0, resolution=farther,
            accuracy="transmittance",
            meaning="Slip in the end over that of the exact motion.",
        ),
    ),
    steps=steps_a_row(STEPS_A_ROW),
    details=(
        f"μ_s / μ_k = {', '.join(f'{ratio:g}' for ratio in STATIC_RATIOS)}; the load reaches μ_s λ_N after "
        f"{RISE_TIME:g} s, and is followed for {FOLLOWED:g} s.",
    ),
)  # fmt: skip
"""What is held by one coefficient of friction, and slides with another, sticks and slips in jumps."""

SCENARIOS = (STATIC_ABOVE_KINETIC,)
