"""Stick and slip of a single cell."""

from scenarios.catalogue.steady.base import SteadyScenario
from scenarios.tasks.parameters import ChainRatios
from scenarios.verdicts.steady_case import SteadyCase

ONE_CELL = ChainRatios(cells=1)


def _case(friction_ratio: float, frequency_ratio: float) -> SteadyCase:
    label = f"friction {friction_ratio:g}, η_r {frequency_ratio:g}"
    return SteadyCase(label=label, friction_ratio=friction_ratio, frequency_ratio=frequency_ratio, ratios=ONE_CELL)


class UnitCell(SteadyScenario):
    """One mass-in-mass cell that sticks briefly, about half of the time, for most of it, and never."""

    name = "unit-cell"
    question = "When does the contact of one cell stick and slip?"
    source = "Sethi, Banerjee, Manna, figure 2 with one cell, mass and stiffness ratio 1, ζ = 0.01"
    expects = "the event-driven solver, exact to round-off"
    cases = (_case(0.6, 0.9), _case(0.1, 0.45), _case(0.6, 1.6), _case(0.3, 0.9))
    with_stick_slip = True
