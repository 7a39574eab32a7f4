"""Models of engines' steps: a formula and its constants, which say why a preset departs from the step of equation (5).

Laws are leaves. The module ``law`` of an engine's package has them, where there is one; the contract holds each to its
engine over one period, and ``run laws`` prints them. They take part in no search and in no verdict.
"""

import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from importlib import import_module
from importlib.util import find_spec
from typing import Self

import numpy as np

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.variant import Variant
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.validation import FloatArray

ROUND_OFF_PERIOD = 1e-11
"""Largest difference of an engine from its law after one period from the same state, over the displacement scale,
where both compute the same in double precision: 400 steps of some ten roundings of 1e-16, grown by the condition of
unequal cells."""

Step = Callable[[FloatArray, FloatArray, FloatArray, FloatArray], tuple[FloatArray, FloatArray]]
"""Takes positions and velocities, shape (2n,), the load at the start and at the end of the step, shape (2,) [N], and
the bounds μ λ_N, shape (n,) [N]; gives positions and velocities of the end. It is made anew for every run, and may
keep what the engine keeps between steps."""


@dataclass(frozen=True)
class Constant:
    """One constant of a law."""

    value: float
    """The number, in SI units."""
    unit: str
    """Its unit; empty for pure numbers."""
    source: str
    """The option that it comes from, or where the engine has it."""
    visible_error: float = 0.01
    """Part of it that an error has to reach to move a motion by more than `Law.bound`."""


@dataclass(frozen=True, kw_only=True)
class Law:
    """How an engine steps a chain with one preset, under a given normal force and in a row that is not turned."""

    formula: str
    """What a step of length h computes, in the notation of `multibody_xval.engines.shared.linear_law`."""
    step: Callable[[Lane, Mapping[str, float]], Step]
    """Makes the step of a lane from the values of the constants."""
    constants: Mapping[str, Constant] = field(default_factory=dict)
    """The numbers in it by their symbols, from the preset's own options."""
    bound: float = ROUND_OFF_PERIOD
    """Largest difference of positions from the engine after one period of 400 steps from the same state, over the
    displacement scale, as long as nothing is wrong."""
    bound_reason: str = "round-off in double precision"
    """Where that difference comes from."""

    def with_constant(self, symbol: str, factor: float) -> Self:
        """Give it with one constant multiplied."""
        constant = self.constants[symbol]
        return replace(self, constants={**self.constants, symbol: replace(constant, value=factor * constant.value)})

    def positions(self, lane: Lane, state: State, steps: int) -> FloatArray:
        """Advance one lane from a state at the start of a period; gives the positions after each step, (steps, 2n)."""
        values = {symbol: constant.value for symbol, constant in self.constants.items()}
        step, loads = self.step(lane, values), lane.loads(0, steps + 1)
        bounds = lane.chain.friction_coefficient * lane.preloads(0, steps)
        position, velocity = state.positions[0].copy(), state.velocities[0].copy()
        rows = np.empty((steps, position.size))
        for number in range(steps):
            position, velocity = step(position, velocity, loads[number : number + 2], bounds[number])
            rows[number] = position
        return rows


def law_of(variant: Variant) -> Law | None:
    """Give the law of a preset, from the module ``law`` in the package of its engine; ``None`` where there is none.

    The module has ``LAWS``, which gives the law of a `Preset` by formulation and name, such as ``joint:default``.

    Raises
    ------
    ParameterError
        If the engine has no such formulation or preset.
    """
    package = sys.modules[type(engine(variant.engine)).__module__].__package__
    if not package or find_spec(f"{package}.law") is None:
        return None
    laws: Mapping[str, Callable[[Preset], Law]] = import_module(f"{package}.law").LAWS
    name = f"{variant.formulation}:{variant.unchanged.preset_name}"
    return laws[name](variant.preset) if name in laws else None
