"""Stick and slip of a single cell."""

from multibody_xval.scenarios.catalogue.steady.base import SteadyScenario, point_case
from multibody_xval.scenarios.runs.parameters import ChainRatios

POINTS = ((0.6, 0.9), (0.1, 0.45), (0.6, 1.6), (0.3, 0.9))
"""Friction and frequency ratios."""


class UnitCell(SteadyScenario):
    """One mass-in-mass cell that sticks briefly, about half of the time, for most of it, and never."""

    name = "unit-cell"
    source = "Sethi, Banerjee, Manna, figure 2 with one cell, mass and stiffness ratio 1, ζ = 0.01"
    cases = tuple(point_case(*point, ChainRatios(cells=1)) for point in POINTS)
    with_stick_slip = True
