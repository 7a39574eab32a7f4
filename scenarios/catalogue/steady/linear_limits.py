"""The two limits that linear theory knows: contacts that slide freely, and contacts that never slide."""

import cmath
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from multibody_xval.scenarios.catalogue.steady.base import ClosedForm, cases_over
from multibody_xval.scenarios.runs.parameters import ChainRatios
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.verdicts.steady_case import Expected, SteadyCase
from reference_lcp.chain.drives import PeriodicDrive
from reference_lcp.chain.linear_response import frictionless_response, stuck_response
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.observables.transmittance import decibel

THREE_CELLS = ChainRatios(cells=3)
"""Enough cells for pass band and stop band, few enough for engines that are slow."""

LOCKING_FRICTION = 5.0
"""Friction ratio, the largest of figure 3, at which no contact slips: at the cases' frequencies the bound is more than
four times the force that holds the inner masses."""


class FrictionlessLimit(ClosedForm):
    """No friction: the resonators move freely."""

    name = "frictionless-limit"
    source = "linear theory: (K + iωC − ω²M) x = f"
    cases = cases_over((0.9, 0.5), 0.0, THREE_CELLS)

    def expected(self, case: SteadyCase, results: Sequence[Result]) -> Expected:
        """Solve the linear chain."""
        return linear_expected(case, frictionless_response)


class LockedLimit(ClosedForm):
    """So much friction that every cell moves as one mass."""

    name = "locked-limit"
    source = "linear theory with v = u + const in every cell"
    cases = cases_over((1.1, 0.7), LOCKING_FRICTION, THREE_CELLS)

    def expected(self, case: SteadyCase, results: Sequence[Result]) -> Expected:
        """Solve the linear chain of locked cells."""
        return linear_expected(case, stuck_response)


def linear_expected(case: SteadyCase, response: Callable[[Chain, PeriodicDrive], NDArray[np.complex128]]) -> Expected:
    """Give the transmittance of a linear chain."""
    chain, drive = case.setting()
    ratio = complex(response(chain, drive)[chain.cells - 1]) / drive.displacement_scale(chain)
    return Expected(transmittance_db=decibel(abs(ratio)), phase=cmath.phase(ratio))
