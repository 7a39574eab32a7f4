"""Transmissibility of broadband and transient motions, by spectra.

A harmonic base gives |U_n| / U_0 at one frequency. A base that moves at many frequencies at once gives it as
the ratio of two spectra: of Fourier transforms for a motion that has a beginning and an end, of averaged power
spectra for a stationary one (J. S. Bendat and A. G. Piersol, "Random Data", chapters 6 and 9). In a linear
chain each is the transmittance of the harmonic base. With friction it belongs to the base motion as a whole.
"""

from dataclasses import dataclass

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from reference_lcp.chain.transient import cosine_rise
from reference_lcp.refusal import ParameterError
from reference_lcp.validation import FloatArray, checked_array, checked_count, checked_scalar

FEWEST_LINES = 3
"""Lines of a spectrum that a band holds at least."""

FALL = 0.3
"""Part of a transient in which it is led to zero at its end."""


@dataclass(frozen=True)
class Transmissibility:
    """What of the base's motion arrives, frequency by frequency.

    Parameters
    ----------
    angular_frequency
        Lines of the spectrum [rad/s], ascending, shape (lines,).
    ratio
        Response over base, complex, shape (lines,).
    base_power
        Power of the base at each line, in any unit, shape (lines,): the weight of the line in a band.
    """

    angular_frequency: FloatArray
    ratio: NDArray[np.complex128]
    base_power: FloatArray

    def in_band(self, lowest: float, highest: float) -> float:
        """Root of response power over base power between two frequencies [rad/s], NaN where the base has no power.

        Raises
        ------
        ParameterError
            If there are fewer than three lines between them.
        """
        inside = (self.angular_frequency >= lowest) & (self.angular_frequency <= highest)
        if np.count_nonzero(inside) < FEWEST_LINES:
            raise ParameterError(
                f"the band {lowest:g} to {highest:g} rad/s holds {np.count_nonzero(inside)} lines of the spectrum; "
                f"allowed: at least {FEWEST_LINES}, by a wider band or a longer motion"
            )
        power = self.base_power[inside]
        return (
            float(np.sqrt(np.sum(np.abs(self.ratio[inside]) ** 2 * power) / np.sum(power))) if np.any(power) else np.nan
        )


def transient_transmissibility(base: FloatArray, response: FloatArray, time_step: float) -> Transmissibility:
    """Ratio of the Fourier transforms of two motions that begin at rest and have died out at the end.

    In the last part of the record, `FALL` of it, both are led to zero by half a cosine: what has not quite died
    out there would leak into every line, and hide a band in which little arrives.

    Parameters
    ----------
    base, response
        Displacements [m] at the same even times, shape (samples,).
    time_step
        Time between samples [s], > 0.

    Raises
    ------
    ParameterError
        If the motions differ in length, or a value is outside its range.
    """
    _check_pair(base, response)
    angular_frequency = 2 * np.pi * scipy.fft.rfftfreq(base.size, checked_scalar("time_step", time_step, "> 0"))
    places = np.arange(base.size, 0, -1, dtype=np.float64) / base.size
    fall = cosine_rise(places, FALL)[0]
    spectrum, response_spectrum = scipy.fft.rfft(base * fall), scipy.fft.rfft(response * fall)
    power = np.abs(spectrum) ** 2
    # a line that the base does not move at has no ratio, and no weight
    ratio = np.divide(response_spectrum, spectrum, out=np.zeros_like(response_spectrum), where=power > 0)
    return Transmissibility(angular_frequency, ratio, power)


def stationary_transmissibility(
    base: FloatArray, response: FloatArray, time_step: float, segment: int
) -> Transmissibility:
    """Estimate H1 of a stationary motion: cross spectrum over the base's power spectrum, by Welch's method.

    Parameters
    ----------
    base, response
        Displacements [m] at the same even times, shape (samples,), after the motion has become stationary.
    time_step
        Time between samples [s], > 0.
    segment
        Samples of each of the half overlapping segments, under a Hann window; at most half of all.

    Raises
    ------
    ParameterError
        If the motions differ in length, or a value is outside its range.
    """
    from scipy.signal import csd, welch

    _check_pair(base, response)
    step = checked_scalar("time_step", time_step, "> 0")
    if checked_count("segment", segment, 8) > base.size // 2:
        raise ParameterError(f"segment = {segment} of {base.size} samples; allowed: at most half of them")
    frequency, power = welch(base, 1 / step, nperseg=segment)
    _, cross = csd(base, response, 1 / step, nperseg=segment)
    ratio = np.divide(cross, power, out=np.zeros_like(cross), where=power > 0)
    return Transmissibility(2 * np.pi * frequency, ratio, power)


def _check_pair(base: FloatArray, response: FloatArray) -> None:
    """Raise a `ParameterError` unless both are finite rows of numbers, as many of each."""
    shapes = checked_array("base", base).shape, checked_array("response", response).shape
    if shapes[0] != shapes[1] or len(shapes[0]) != 1:
        raise ParameterError(f"base and response have shapes {shapes[0]} and {shapes[1]}; allowed: both (samples,)")
