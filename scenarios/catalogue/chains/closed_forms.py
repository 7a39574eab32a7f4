"""Steady states that are known in closed form: no friction, contacts that hold, Den Hartog's oscillator."""

import math
from dataclasses import replace

from multibody_xval.scenarios.catalogue.scenario import STICK_SLIP, TRANSMITTANCE, Scenario, steady_steps
from multibody_xval.scenarios.model import Case, linear_limits
from reference_lcp.exact.den_hartog import SlidingMotion

CELLS = 3
"""Enough cells for pass band and stop band, few enough for engines that are slow."""


FRICTIONLESS_LIMIT = Scenario(
    name="frictionless-limit",
    question="Without friction, does the chain move as linear theory says?",
    expects="the closed form; of presets that share the scheme the reference at equal steps",
    source="linear theory: (K + iωC − ω²M) x = f",
    cases={f"η_r {eta:g}": Case(friction_ratio=0.0, frequency_ratio=eta, cells=CELLS) for eta in (0.9, 0.5)},
    quantities=(replace(TRANSMITTANCE, exact=lambda case: linear_limits(case)[0]),),
    steps=steady_steps,
)

LOCKING_FRICTION = 5.0
"""Friction ratio, the largest of figure 3, at which no contact slips: at the cases' frequencies the bound is more than
four times the force that holds the inner masses."""

LOCKED_LIMIT = replace(
    FRICTIONLESS_LIMIT,
    name="locked-limit",
    question="Does a contact with a very high friction bound hold?",
    source="linear theory with v = u + const in every cell",
    cases={
        f"η_r {eta:g}": Case(friction_ratio=LOCKING_FRICTION, frequency_ratio=eta, cells=CELLS) for eta in (1.1, 0.7)
    },
    quantities=(replace(TRANSMITTANCE, exact=lambda case: linear_limits(case)[1]),),
)

STANDING_RATIO = 1e6
"""Mass ratio of the cell: its inner mass moves by a millionth of what the outer one does."""

STIFFNESS_RATIO = 1.0

DAMPING_RATIO = 1e-9
"""Of the chain's dashpot, which the closed form does not have: without any, the heavy mass may swing for ever, and the
steady state is one of many. It changes T by a hundredth of the bar."""

OSCILLATOR_UNIT = math.sqrt((1 + 1 / STIFFNESS_RATIO) * STANDING_RATIO)
"""Frequency of the oscillator, √((k_c + k_i) / m_o), over that of the cell, √(k_i / m_i)."""


def oscillator(frequency_ratio: float, force_ratio: float) -> Case:
    """Give an outer mass that slides on an inner one, as heavy as a million of it, which stands still.

    The base moves it through the chain's spring, with hardly any dashpot: a force P0 = k_c U0 on an oscillator of the
    stiffness k_c + k_i, so that F/P0 is the friction ratio. The frequency is that over the oscillator's own.
    """
    return Case(
        friction_ratio=force_ratio, frequency_ratio=frequency_ratio * OSCILLATOR_UNIT, cells=1,
        mass_ratio=STANDING_RATIO, stiffness_ratio=STIFFNESS_RATIO, damping_ratio=DAMPING_RATIO,
    )  # fmt: skip


POINTS = ((0.8, 0.3), (1.3, 0.4), (0.6, 0.2))
"""Frequency over the oscillator's own, and friction over the amplitude of the force; the mass never stops."""

SLIDING = {oscillator(*point): SlidingMotion.of(*point) for point in POINTS}


def sliding_response(case: Case) -> complex:
    """Give T of the sliding motion."""
    return SLIDING[case].response / (1 + STIFFNESS_RATIO)


def left_by_standing(case: Case) -> float:
    """Give what the heavy mass, which does not quite stand, makes of T.

    k_i x0 and the friction, with the fundamental 4F/π, accelerate it; by its motion k_i drives the oscillator too.
    """
    motion = SLIDING[case]
    spring = STIFFNESS_RATIO / (1 + STIFFNESS_RATIO)
    pulled = spring + 4 / math.pi * motion.force_ratio / motion.amplitude
    moved = pulled / (STANDING_RATIO * motion.frequency_ratio**2)
    return moved * spring / abs(1 - motion.frequency_ratio**2) * abs(sliding_response(case))


DEN_HARTOG = Scenario(
    name="den-hartog",
    question="How does a mass slide with dry friction under a harmonic force, and when does it turn back?",
    expects="the closed form, its bar is the motion of the heavy mass, and for turns the event-driven motion; of "
    "presets that share the scheme the reference at equal steps",
    source="J. P. Den Hartog, Trans. ASME 53 (1931)",
    cases={f"r {motion.frequency_ratio:g}, F/P0 {motion.force_ratio:g}": case for case, motion in SLIDING.items()},
    quantities=(replace(TRANSMITTANCE, exact=sliding_response, bar=left_by_standing), *STICK_SLIP),
    steps=steady_steps,
)

SCENARIOS = (FRICTIONLESS_LIMIT, LOCKED_LIMIT, DEN_HARTOG)
