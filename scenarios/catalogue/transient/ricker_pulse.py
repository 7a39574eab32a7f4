"""A Ricker pulse of the base: a transient that holds all frequencies around ω_r at once."""

from multibody_xval.scenarios.catalogue.transient.base import RESONATOR_FREQUENCY, Broadband, TransientCase
from reference_lcp.chain.transient import QUIET, RickerPulse
from reference_lcp.defaults import BASE_AMPLITUDE


class RickerPulseScenario(Broadband):
    """A pulse that is strong for its friction loses more below the attenuation band; a weak one finds the cells locked.

    Without friction the band 0.65–0.82 lets −2.4 dB pass; at the ratio 0.03 it is −4.8 dB, at 0.1 +0.8 dB.
    """

    name = "ricker-pulse"
    friction_ratios = (0.0, 0.03, 0.1)

    def case(self, friction_ratio: float) -> TransientCase:
        """Follow the pulse until it has died out."""
        pulse = RickerPulse(BASE_AMPLITUDE, RESONATOR_FREQUENCY, QUIET / RESONATOR_FREQUENCY)
        return TransientCase(friction_ratio, pulse, 300)
