"""Chains whose cells all differ: at random, and by a gradient."""

import dataclasses
from typing import ClassVar

import numpy as np

from multibody_xval.scenarios.catalogue.steady.base import SteadyScenario, cases_over
from multibody_xval.scenarios.runs.parameters import ChainRatios, Ratio
from multibody_xval.scenarios.verdicts.steady_case import SteadyCase

DISORDER_SEED = 3
"""Of the disordered chain: five of its seven contacts slip at η_r = 0.6, in 22 transitions a period; six at 0.9."""

SPREAD = (0.7, 1.3)
"""Range of all masses and springs, as ratios, 30 % to either side of the canonical case."""

FRICTION_SPAN = (0.1, 0.5)
"""Range of the friction ratios, around the one with the widest band."""

CELLS = 7


def disordered() -> tuple[Ratio, ChainRatios]:
    """Draw friction, both masses, both springs and dashpot of each cell, to two digits."""
    draw = np.random.default_rng(DISORDER_SEED)
    mass, stiffness, friction = (_numbers(draw.uniform(*span, CELLS)) for span in (SPREAD, SPREAD, FRICTION_SPAN))
    damping = _numbers(draw.uniform(0.5, 1.5, CELLS), 0.01)
    outer, springs = (_numbers(draw.uniform(*SPREAD, CELLS)) for _ in range(2))
    ratios = ChainRatios(
        cells=CELLS,
        mass_ratio=mass,
        stiffness_ratio=stiffness,
        damping_ratio=damping,
        outer_mass_ratio=outer,
        chain_stiffness_ratio=springs,
    )
    return friction, ratios


def graded() -> tuple[Ratio, ChainRatios]:
    """Let resonators become heavier and softer, and friction stronger, along the chain."""
    low, high = SPREAD
    mass, stiffness = _numbers(np.linspace(low, high, CELLS)), _numbers(np.linspace(high, low, CELLS))
    ratios = ChainRatios(cells=CELLS, mass_ratio=mass, stiffness_ratio=stiffness)
    return _numbers(np.linspace(*FRICTION_SPAN, CELLS)), ratios


def _numbers(values: np.ndarray, scale: float = 1.0) -> tuple[float, ...]:
    return tuple(float(np.round(scale * np.round(value, 2), 6)) for value in values)


class UnequalCells(SteadyScenario):
    """What the two chains have in common."""

    with_stick_slip = True
    cases: ClassVar[tuple[SteadyCase, ...]] = ()

    def parameters(self) -> list[str]:
        """Give the ratios cell by cell."""
        numbers = {**dataclasses.asdict(self.cases[0].ratios), "friction_ratio": self.cases[0].friction_ratio}
        return [
            f"{name} = {', '.join(f'{value:g}' for value in values)}"
            for name, values in numbers.items()
            if isinstance(values, tuple)
        ]


class DisorderedChain(UnequalCells):
    """Every cell has masses, springs, a dashpot and friction of its own, drawn at random."""

    name = "disordered-chain"
    source = f"ratios drawn from even distributions, seed {DISORDER_SEED}"
    cases = cases_over((0.6, 0.9), *disordered())


class GradedChain(UnequalCells):
    """Resonators tuned lower and lower along the chain (a rainbow trap), with more and more friction."""

    name = "graded-chain"
    source = "graded resonators (rainbow trapping), linear in the cell's number"
    cases = cases_over((0.6, 0.8), *graded())
