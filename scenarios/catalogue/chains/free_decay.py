"""Free decay: a chain that is let go, and the friction that brings its contacts to rest."""

import math
from functools import partial

import numpy as np

from multibody_xval.scenarios.cases.motions import ChainMotion
from multibody_xval.scenarios.catalogue.scenario import Quantity, Scenario, largest, steps_a_row
from multibody_xval.scenarios.model import EXACT, Case, Result, Run
from reference_lcp.chain.drives import StillBase
from reference_lcp.validation import FloatArray

ROWS_PER_PERIOD = 100
"""Rows to a period 2π / ω_r: a time is read to one of them."""

STEPS_A_ROW = 4

EXACT_REFINEMENT = 2
"""Rows of the exact motion to a step: heat of dashpots is a sum over them, good to 3e-7 of the energy."""

SCALE = 0.01
"""Displacement scale [m]: the U0 of the friction ratio."""

ROUND_OFF = 1e-6
"""Of energies and offsets: the heat of the exact motion's dashpots, see `EXACT_REFINEMENT`."""


def let_go(shape: str, periods: int, friction_ratio: float, **ratios: float) -> ChainMotion:
    """Give a chain that is let go, and followed for so many periods 2π / ω_r."""
    chain = Case(friction_ratio=friction_ratio, frequency_ratio=1.0, **ratios).chain  # type: ignore[arg-type]
    return ChainMotion(
        friction_ratio=friction_ratio, drive=StillBase(SCALE), time=periods * 2 * math.pi / chain.resonator_frequency,
        rows=periods * ROWS_PER_PERIOD, shape=shape, recorded="decay", **ratios,  # type: ignore[arg-type]
    )  # fmt: skip


# an outer mass of 10,000 inner ones on a spring of 40,000 inner ones: it moves by less than 1e-4
OSCILLATOR = let_go(
    "inner masses displaced", 8, 0.06 * 0.25e-4, cells=1, mass_ratio=1e-4, stiffness_ratio=0.25e-4, damping_ratio=0.0
)


def half_width(run: Run) -> float:
    """F / k_i of cell 1, over the displacement scale: half of the dead band."""
    chain = run.of(ChainMotion).chain
    return float(chain.friction_bound[0] / chain.inner_stiffness[0]) / SCALE


def rest_time(result: Result, run: Run) -> float:
    """Give when the last contact came to rest, over the period of the resonator."""
    return result.series["rest"][0] * run.of(ChainMotion).chain.resonator_frequency / (2 * math.pi)


def offsets(result: Result, run: Run) -> FloatArray:
    """Give v − u at the end of all cells, over F / k_i."""
    return np.array(result.series["offsets"]) / half_width(run)


def heat(result: Result, run: Run) -> float:
    """Give the heat of contacts; of the exact motion what is missing: friction jumps between rows, dashpots do not."""
    left, dashpots, contacts, _ = result.series["energy"]
    return 1 - left - dashpots if run.config == EXACT else contacts


def loss_a_cycle(swing: FloatArray) -> float:
    """Amplitude that an oscillation from 1 loses from one turn to the next but one, on average while it swings."""
    turns = [1.0]
    sides = np.sign(swing)
    starts = np.flatnonzero(np.diff(sides, prepend=sides[0]) != 0)
    turns += [float(np.max(np.abs(stretch))) for stretch in np.split(swing, starts)[1:]]
    return 2 * (turns[0] - turns[-1]) / (len(turns) - 1) if len(turns) > 1 else math.nan


of_size = partial(Quantity, unit="", accuracy="transmittance", resolution=ROUND_OFF, effect=1.0)
"""Of F / k_i, or of the initial energy."""

share = partial(of_size, group="energy")
"""Of one energy."""


FREE_DECAY = Scenario(
    name="free-decay",
    question="When does friction stop a chain that is let go, where, and into what does its energy go?",
    expects="the event-driven motion, exact to round-off, and closed forms; of presets that share the scheme the "
    "reference at equal steps",
    source="Free vibration with Coulomb damping, 4 F / k a cycle: J. P. Den Hartog, Mechanical Vibrations; chain: "
    "figure 3 of Sethi, Banerjee and Manna.",
    cases={
        "friction oscillator": OSCILLATOR,
        "inner masses let go": let_go("inner masses displaced", 30, 0.1),
        "stretched chain let go": let_go("stretched", 80, 0.02),
    },
    quantities=(
        Quantity(
            name="time to rest", unit="T_r", read=rest_time, resolution=1 / ROWS_PER_PERIOD,
            meaning="When the last contact came to rest, over the period 2π / ω_r of the resonator.",
        ),
        of_size(name="offsets", read=offsets, meaning="Largest difference of v − u at the end, over F / k_i."),
        of_size(
            name="dead band", exact=0.0, read=lambda result, run: max(0.0, largest(offsets(result, run)) - 1),
            meaning="By how much the largest |v − u| at the end is beyond F / k_i, over F / k_i.",
        ),
        share(
            name="heat of contacts", read=heat,
            meaning="Energy that contacts have turned into heat, over the initial energy.",
        ),
        share(
            name="energy left", read=lambda result, _run: result.series["energy"][0],
            meaning="Energy of the chain at the end, over the initial one.",
        ),
        share(
            name="balance", read=lambda result, _run: 1 - sum(result.series["energy"][:3]), exact=0.0,
            meaning="Initial energy less what is left and all heat, over the initial energy.",
        ),
        of_size(
            name="growth", read=lambda result, _run: result.series["energy"][3], exact=0.0,
            meaning="Largest growth of the energy over the least so far, over the initial energy.",
        ),
        Quantity(
            name="loss a cycle", unit="", exact=1.0, of=lambda case: case == OSCILLATOR,
            resolution=1e-4,  # the outer mass stands still in the closed form
            read=lambda result, run: loss_a_cycle(np.array(result.series["swing"])) / (4 * half_width(run)),
            meaning="Amplitude that the friction oscillator loses in a cycle, over 4 F / k_i.",
        ),
    ),
    steps=steps_a_row(STEPS_A_ROW),
    exact_refinement=EXACT_REFINEMENT,
)  # fmt: skip
"""Dry friction stops a motion after a finite time, anywhere within a dead band; dashpots never do."""

SCENARIOS = (FREE_DECAY,)
