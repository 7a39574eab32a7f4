"""Steady states of chains under a harmonic drive."""

from dataclasses import replace

import numpy as np

from multibody_xval.scenarios.catalogue.scenario import STICK_SLIP, TRANSMITTANCE, Scenario, steady_steps
from multibody_xval.scenarios.chain_ratios import Ratio
from multibody_xval.scenarios.model import Case, value_text
from reference_lcp.validation import FloatArray


def at_points(points: tuple[tuple[float, float], ...], cells: int = 1) -> dict[str, Case]:
    """Give the cases of friction and frequency ratios, by both."""
    return {
        f"friction {friction:g}, η_r {eta:g}": Case(friction_ratio=friction, frequency_ratio=eta, cells=cells)
        for friction, eta in points
    }


UNIT_CELL = Scenario(
    name="unit-cell",
    question="Does a single cell respond as it should, and stick and slip when it should?",
    expects="the proven steady state, or the event-driven motion; of presets that share the scheme the reference at "
    "equal steps",
    source="Sethi, Banerjee, Manna, figure 2 with one cell, mass and stiffness ratio 1, ζ = 0.01",
    cases=at_points(((0.6, 0.9), (0.1, 0.45), (0.6, 1.6), (0.3, 0.9))),
    quantities=(TRANSMITTANCE, *STICK_SLIP),
    steps=steady_steps,
)
"""It sticks briefly, about half of the time, for most of it, and never."""

SPREAD = (0.7, 1.3)
"""Range of all masses and springs of unequal cells, as ratios, 30 % to either side of the paper's."""

FRICTION_SPAN = (0.1, 0.5)
"""Range of their friction ratios, around the one with the widest band."""

CELLS = 7

DISORDER_SEED = 3
"""Of the disordered chain: five of its seven contacts slip at η_r = 0.6, in 22 transitions a period; six at 0.9."""


def disordered() -> dict[str, Ratio]:
    """Draw friction, both masses, both springs and dashpot of each cell, to two digits."""
    draw = np.random.default_rng(DISORDER_SEED)
    mass, stiffness, friction = (_numbers(draw.uniform(*span, CELLS)) for span in (SPREAD, SPREAD, FRICTION_SPAN))
    damping = _numbers(draw.uniform(0.5, 1.5, CELLS), 0.01)
    outer, springs = (_numbers(draw.uniform(*SPREAD, CELLS)) for _ in range(2))
    return {
        "friction_ratio": friction, "mass_ratio": mass, "stiffness_ratio": stiffness, "damping_ratio": damping,
        "outer_mass_ratio": outer, "chain_stiffness_ratio": springs,
    }  # fmt: skip


def graded() -> dict[str, Ratio]:
    """Let resonators become heavier and softer, and friction stronger, along the chain."""
    low, high = SPREAD
    mass, stiffness = _numbers(np.linspace(low, high, CELLS)), _numbers(np.linspace(high, low, CELLS))
    return {
        "friction_ratio": _numbers(np.linspace(*FRICTION_SPAN, CELLS)), "mass_ratio": mass, "stiffness_ratio": stiffness
    }  # fmt: skip


def _numbers(values: FloatArray, scale: float = 1.0) -> tuple[float, ...]:
    return tuple(float(np.round(scale * np.round(value, 2), 6)) for value in values)


def over(frequency_ratios: tuple[float, ...], ratios: dict[str, Ratio]) -> dict[str, Case]:
    """Give the cases of one chain at several frequencies."""
    return {f"η_r {eta:g}": Case(frequency_ratio=eta, cells=CELLS, **ratios) for eta in frequency_ratios}  # type: ignore[arg-type]


def cell_by_cell(ratios: dict[str, Ratio]) -> tuple[str, ...]:
    """Give the ratios of a chain in lines."""
    return tuple(f"{name} = {value_text(value)}" for name, value in ratios.items())


DISORDERED_CHAIN = replace(
    UNIT_CELL,
    name="disordered-chain",
    question="With other parameters in each cell, when does each contact stick and slip?",
    source=f"ratios drawn from even distributions, seed {DISORDER_SEED}",
    cases=over((0.6, 0.9), disordered()),
    details=cell_by_cell(disordered()),
)

GRADED_CHAIN = replace(
    UNIT_CELL,
    name="graded-chain",
    question="Where along a graded chain do the contacts stick?",
    source="graded resonators (rainbow trapping), linear in the cell's number",
    cases=over((0.6, 0.8), graded()),
    details=cell_by_cell(graded()),
)

SCENARIOS = (UNIT_CELL, DISORDERED_CHAIN, GRADED_CHAIN)
