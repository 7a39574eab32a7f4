"""Steady states that are known in closed form: no friction, contacts that hold, Den Hartog's oscillator."""

import math
from dataclasses import replace

from multibody_xval.scenarios.catalogue.scenario import STICK_SLIP, TRANSMITTANCE, Scenario, steady_steps
from multibody_xval.scenarios.model import Case, linear_limits
from reference_lcp.exact.continuous_sliding import SlidingMotion

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
"""Of the chain's dashpot: without any, the heavy mass may swing for ever, and the steady state is one of many."""

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


def sliding_response(case: Case) -> complex:
    """Give T of a chain whose one contact slides without a stop."""
    chain, drive = case.setting
    fundamental = SlidingMotion.of_chain(chain, drive).fundamental[chain.cells - 1]
    return complex(fundamental) / drive.displacement_scale(chain)


DEN_HARTOG = Scenario(
    name="den-hartog",
    question="How does a mass slide with dry friction under a harmonic force, and when does it turn back?",
    expects="the closed form, and for turns the event-driven motion; of presets that share the scheme the reference at "
    "equal steps",
    source="J. P. Den Hartog, Trans. ASME 53 (1931)",
    cases={f"r {ratio:g}, F/P0 {force:g}": oscillator(ratio, force) for ratio, force in POINTS},
    quantities=(replace(TRANSMITTANCE, exact=sliding_response), *STICK_SLIP),
    steps=steady_steps,
)

ONE_CONTACT = replace(
    DEN_HARTOG,
    name="one-contact",
    question="How does a chain move whose only contact slides without a stop?",
    source="L. Marino and A. Cicirello, Nonlinear Dynamics 106 (2021): friction between two masses of a chain",
    cases={
        "2 masses, η_r 0.9": Case(friction_ratio=0.2, frequency_ratio=0.9, cells=1),
        "2 masses, η_r 1.7": Case(friction_ratio=0.4, frequency_ratio=1.7, cells=1),
        "6 masses, the first pair, η_r 1.2": Case(friction_ratio=(0.3, 0.0, 0.0), frequency_ratio=1.2, cells=3),
        "6 masses, the last pair, η_r 0.7": Case(friction_ratio=(0.0, 0.0, 0.2), frequency_ratio=0.7, cells=3),
    },
)

SCENARIOS = (FRICTIONLESS_LIMIT, LOCKED_LIMIT, DEN_HARTOG, ONE_CONTACT)
