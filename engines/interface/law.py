"""The law of a preset, as a model that predicts the engine: a formula, its constants, and the steps that they make."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from multibody_xval.engines.interface.tolerances import STEPS
from reference_lcp.chain.simulation import Lane, common_cells
from reference_lcp.schemes.sequential import LaneModel, SequentialSimulation

ROUND_OFF_PERIOD = 1e-11
"""Largest difference of an engine from its law after one period from the same state, over the displacement scale,
where both compute the same in double precision: 400 steps of some ten roundings of 1e-16, grown by the condition of
unequal cells."""


NEAR = 1e-4
"""Of the way between a constant and its ideal value, what is left near that."""


@dataclass(frozen=True)
class Constant:
    """One constant of a law."""

    value: float
    """The number, in SI units."""
    unit: str
    """Its unit; empty for pure numbers."""
    source: str
    """The option that it comes from, or where the engine has it."""
    too_small_to_see: bool = False
    """The whole of it moves nothing by more than `Law.period_bound`."""
    ideal: float | None = None
    """With it, and ever finer steps, the law is Coulomb's; infinity is approached. ``None`` where the constant loses
    its effect with the step anyway."""
    visible_error: float = 0.01
    """Part of it that an error has to reach to move something by more: above a hundredth where the whole moves only
    some ten bounds."""

    def near_ideal(self) -> "Constant":
        """Give it with a value near the ideal one, where it has one."""
        if self.ideal is None:
            return self
        if math.isinf(self.ideal):
            return replace(self, value=self.value / NEAR)
        return replace(self, value=self.ideal + NEAR * (self.value - self.ideal))


@dataclass(frozen=True, kw_only=True)
class Law:
    """How an engine steps a chain with one preset."""

    formula: str
    """What a step computes, in the notation of `reference_lcp.schemes.linear_implicit`."""
    model: Callable[[Lane, Mapping[str, float]], LaneModel]
    """Makes the model of a lane from the values of the constants."""
    constants: Mapping[str, Constant] = field(default_factory=dict)
    """The numbers in it by their symbols, from the preset's own options."""
    period_bound: float = ROUND_OFF_PERIOD
    """Largest difference of positions from the engine after one period from the same state, over the displacement
    scale, as long as nothing is wrong, at `STEPS` steps a period; see `bound_at`."""
    bound_growth: float = 0.0
    """Power of the number of steps with which that difference grows: a half where every step rounds by as much as a
    longer one, for roundings add up as the root of their number."""
    bound_reason: str = "round-off in double precision"
    """Where that difference comes from."""
    modulated: bool = False
    """It holds under a normal force that changes while contacts stay closed, too."""
    lifting: bool = False
    """It holds where contacts open and close, too; its state then has their gaps."""
    without_friction: str = ""
    """Why no constants make its friction Coulomb's: the law is then one of the chain's alone. Empty where some do."""
    settles: bool = True
    """A motion of it comes to a steady state wherever Coulomb's does, but for few points."""
    unmodelled_reason: Callable[[Lane], str | None] = lambda _: None
    """Says why it does not predict the engine in a lane with such a normal force; gives ``None`` where it does."""

    def bound_at(self, steps: int) -> float:
        """Give `period_bound` for a period of so many steps."""
        return self.period_bound * max(1.0, steps / STEPS) ** self.bound_growth

    def ideal(self) -> "Law":
        """Give the law with every constant near its ideal value."""
        return replace(self, constants={symbol: each.near_ideal() for symbol, each in self.constants.items()})

    def unclaimed_reason(self, lane: Lane) -> str | None:
        """Say why it does not claim to predict a lane; ``None`` if it does."""
        return self.other_contact_reason(lane) or self.unmodelled_reason(lane)

    def other_contact_reason(self, lane: Lane) -> str | None:
        """Say why the contacts of a lane are others than those that it models; ``None`` if they are not."""
        if lane.static_ratio != 1:
            return "it holds for one coefficient of friction, and these contacts have two"
        if lane.opens and not self.lifting:
            return "it holds for closed contacts alone, and these open"
        if lane.preload is not None and not self.modulated:
            return "it holds under a constant normal force alone, and this contact is free across the row"
        return None

    def build(self, lanes: Sequence[Lane]) -> SequentialSimulation:
        """Build every lane.

        Raises
        ------
        ParameterError
            If the chains of the lanes differ in length.
        """
        common_cells(lanes)
        values = {symbol: constant.value for symbol, constant in self.constants.items()}
        return SequentialSimulation([self.model(lane, values) for lane in lanes])


@dataclass(frozen=True)
class NotModelled:
    """A preset whose steps no model predicts."""

    reason: str
    """What decides them instead, in a sentence."""
    nearly: Law | None = None
    """A model that predicts most steps: where its motion does not settle, and the engine's next period is its, the
    engine is not searched any further."""
