"""Band-limited noise of the base: a stationary motion without a period."""

from multibody_xval.scenarios.catalogue.transient.base import (
    PERIOD,
    RESONATOR_FREQUENCY,
    ROWS_PER_PERIOD,
    Broadband,
    TransientCase,
)
from reference_lcp.chain.transient import FilteredNoise
from reference_lcp.defaults import BASE_AMPLITUDE
from reference_lcp.observables.transmittance import Transmissibility, stationary_transmissibility
from reference_lcp.validation import FloatArray

PERIODS = 300
"""Length of the noise in periods 2π / ω_r; it does not repeat before."""

RISE, STARTED = 10, 50
"""Periods in which the noise comes up, and after which the initial transient has died out and spectra begin."""

SEGMENT = 80
"""Periods in a segment of Welch's average: lines of η_r are 1/80 apart, and there are five half overlapping segments.

Shorter ones flatten the resonances: by 1 dB at 50 periods, of a chain as damped as this one.
"""


class FilteredNoiseScenario(Broadband):
    """H1, cross spectrum over the base's: what of the response follows the base; what friction makes of it is left out.

    Without friction the band 0.65–0.82 lets −2.5 dB pass; at the ratio 0.1 it is −6.3 dB, at 0.3 −0.3 dB again.
    """

    name = "filtered-noise"
    friction_ratios = (0.1, 0.3)

    def case(self, friction_ratio: float) -> TransientCase:
        """Noise throughout, from rest."""
        noise = FilteredNoise(
            amplitude=BASE_AMPLITUDE,
            lowest_frequency=0.2 * RESONATOR_FREQUENCY,
            highest_frequency=2.4 * RESONATOR_FREQUENCY,
            repetition=PERIODS * PERIOD,
            rise=RISE * PERIOD,
            seed=1,
        )
        return TransientCase(friction_ratio, noise, PERIODS)

    def spectrum(self, base: FloatArray, response: FloatArray, time_step: float) -> Transmissibility:
        """Average spectra over segments of the stationary part."""
        first = STARTED * ROWS_PER_PERIOD
        return stationary_transmissibility(base[first:], response[first:], time_step, SEGMENT * ROWS_PER_PERIOD)
