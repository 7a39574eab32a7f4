"""The ranges that a user may ask for, as a design of few chains: contract and scenarios visit the same ones."""

from typing import NamedTuple

from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.defaults import BASE_AMPLITUDE


class RangePoint(NamedTuple):
    """One chain under a harmonic base motion; the parameters are those of `Chain.from_ratios`."""

    friction_coefficient: float
    friction_ratio: float
    frequency_ratio: float
    damping_ratio: float
    inner_damping_ratio: float
    mass_ratio: float
    stiffness_ratio: float
    cells: int
    steps: int
    """A period, at least."""

    @property
    def chain(self) -> Chain:
        """Build the chain."""
        return Chain.from_ratios(
            cells=self.cells,
            mass_ratio=self.mass_ratio,
            stiffness_ratio=self.stiffness_ratio,
            damping_ratio=self.damping_ratio,
            friction_ratio=self.friction_ratio,
            inner_damping_ratio=self.inner_damping_ratio,
            friction_coefficient=self.friction_coefficient,
        )

    @property
    def lane(self) -> Lane:
        """Build the chain under its drive."""
        chain = self.chain
        return Lane.periodic(chain, HarmonicBase.from_ratio(chain, self.frequency_ratio, BASE_AMPLITUDE), self.steps)


DESIGN = (
    RangePoint(0.60, 0.10, 0.60, 0.300, 0.00, 1.0, 1.0, 3, 1000),
    RangePoint(0.05, 0.10, 0.15, 0.005, 0.00, 1.0, 1.0, 7, 400),
    RangePoint(0.90, 1.00, 2.00, 0.020, 0.00, 3.0, 0.5, 1, 500),
    RangePoint(1.30, 0.02, 0.30, 0.050, 0.20, 0.3, 0.3, 5, 600),
    RangePoint(2.00, 1.00, 0.90, 0.010, 0.02, 2.0, 3.0, 2, 400),
    RangePoint(0.35, 0.20, 1.20, 0.100, 0.10, 0.5, 2.0, 1, 700),
)
"""Every parameter at the ends of its range and between them, so that each value meets others of all other parameters.

Coefficients of friction 0.05 to 2, friction ratios 0.02 to 1, η_r 0.15 to 2, ζ 0.005 to 0.3, of resonators 0 to 0.2,
mass and stiffness ratios 0.3 to 3, 1 to 7 cells, 400 to 1,000 steps a period. Contacts slip at each of them, and
friction changes each steady state by more than a step leaves open.
"""

LONG_USE = 60_000
"""Steps, and with it a time, beyond which nothing may change: the longest motion of other scenarios takes so many."""

MANY_RUNS = 200
"""Runs of one simulation after which nothing may change either."""
