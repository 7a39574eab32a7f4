"""A swept sine of the base, slow enough for the chain to follow: figure 3 in one motion."""

import math

from multibody_xval.scenarios.catalogue.transient.base import RESONATOR_FREQUENCY, Broadband, TransientCase
from reference_lcp.chain.transient import SweptSine
from reference_lcp.defaults import BASE_AMPLITUDE

SWEEP, REST = 250, 100
"""Periods 2π / ω_r of the sweep, and of the rest in which the chain dies out."""


class SweptSineScenario(Broadband):
    """The sweep passes each band so slowly that the chain responds to one frequency at a time, as in figure 3.

    Without friction the band 0.65–0.82 lets −2.2 dB pass; at the ratio 0.1 it is −7.8 dB, at 0.3 −4.7 dB.
    """

    name = "swept-sine"
    friction_ratios = (0.1, 0.3)

    def case(self, friction_ratio: float) -> TransientCase:
        """Sweep, then wait."""
        omega = RESONATOR_FREQUENCY
        sweep = SweptSine(BASE_AMPLITUDE, 0.2 * omega, 2.4 * omega, SWEEP * 2 * math.pi / omega)
        return TransientCase(friction_ratio, sweep, SWEEP + REST)
