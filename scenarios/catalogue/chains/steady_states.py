"""Steady states of chains under a harmonic drive."""

from dataclasses import replace

import numpy as np

from multibody_xval.engines.shared.wide_range import DESIGN
from multibody_xval.scenarios.cases.chain_ratios import Ratio
from multibody_xval.scenarios.catalogue.scenario import STICK_SLIP, TRANSMITTANCE, Scenario, steady_steps
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

CELLS = 7

HALF_WIDTH = 0.004
"""Distance in η_r from an edge of the two points that are compared, on its flanks."""

LOWER_EDGES = {0.3: 0.637, 1.0: 0.999}
"""Friction ratios of the widest band and of cells that nearly lock; its lower edges, to three digits."""

FLANKS = tuple(
    (friction, round(edge + side, 6)) for friction, edge in LOWER_EDGES.items() for side in (-HALF_WIDTH, HALF_WIDTH)
)

FIGURE3 = replace(
    UNIT_CELL,
    name="figure3",
    question="How much of the base's motion reaches the end of seven cells, and where does attenuation begin?",
    source="Sethi, Banerjee, Manna, figure 3: mass and stiffness ratio 1, ζ = 0.01, seven cells",
    cases=at_points((*FLANKS, (0.6, 0.9), (0.1, 0.6)), CELLS),
    quantities=(TRANSMITTANCE,),
)
"""Points of the figure; ``run figure3`` measures all of it, with the edges."""

SPREAD = (0.7, 1.3)
"""Range of all masses and springs of unequal cells, as ratios, 30 % to either side of the paper's."""

FRICTION_SPAN = (0.1, 0.5)
"""Range of their friction ratios, around the one with the widest band."""

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


def unequal(frequency_ratios: tuple[float, ...], ratios: dict[str, Ratio], **words: str) -> Scenario:
    """Ask for the steady states of one chain of unequal cells at several frequencies."""
    return replace(
        UNIT_CELL,
        cases={f"η_r {eta:g}": Case(frequency_ratio=eta, cells=CELLS, **ratios) for eta in frequency_ratios},  # type: ignore[arg-type]
        details=tuple(f"{name} = {value_text(value)}" for name, value in ratios.items()),
        **words,  # type: ignore[arg-type]
    )


DISORDERED_CHAIN = unequal(
    (0.6, 0.9),
    disordered(),
    name="disordered-chain",
    question="With other parameters in each cell, when does each contact stick and slip?",
    source=f"ratios drawn from even distributions, seed {DISORDER_SEED}",
)

GRADED_CHAIN = unequal(
    (0.6, 0.8),
    graded(),
    name="graded-chain",
    question="Where along a graded chain do the contacts stick?",
    source="graded resonators (rainbow trapping), linear in the cell's number",
)

LONG_CHAIN = replace(
    FIGURE3,
    name="long-chain",
    question="Is an engine as accurate with fifty cells as with seven?",
    expects="the proven steady state; of presets that share the scheme the reference at equal steps",
    source="the paper's chain with more cells, at friction ratio 0.1 and η_r 0.5",
    cases={f"{cells} cells": Case(friction_ratio=0.1, frequency_ratio=0.5, cells=cells) for cells in (7, 15, 30, 50)},
)
"""In the pass band, where friction takes most of the motion from the longest chain and hardly any from the shortest."""


STEPS = {
    Case(**{name: own for name, own in point._asdict().items() if name != "steps"}): point.steps for point in DESIGN
}
"""Per period, at least."""

WIDE_RANGE = replace(
    FIGURE3,
    name="wide-range",
    question="Is an engine right for other friction coefficients, dashpots, frequencies and steps than figure 3 has?",
    source="a design of few chains, every parameter at the ends of its range and between them",
    cases={
        f"μ {case.friction_coefficient:g}, friction {case.friction_ratio:g}, η_r {case.frequency_ratio:g}, "
        f"ζ {case.damping_ratio:g}": case
        for case in STEPS
    },
    steps=lambda _config, case: {"": case.steps(STEPS[case])},
    details=[
        f"μ {case.friction_coefficient:g}: ζ of resonators {case.inner_damping_ratio:g}, mass ratio "
        f"{case.mass_ratio:g}, stiffness ratio {case.stiffness_ratio:g}, cells {case.cells}, steps per period {steps}"
        for case, steps in STEPS.items()
    ],
)

SCENARIOS = (UNIT_CELL, FIGURE3, DISORDERED_CHAIN, GRADED_CHAIN, LONG_CHAIN, WIDE_RANGE)
