"""Broadband and transient base motions: what of them arrives at the end of the chain, by spectra.

Two motions under one drive never drift apart while the normal force is given (friction is monotone), so that
errors of the steps before do not grow, and time series are compared as they are, over the whole motion.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache, partial
from typing import Any

import numpy as np

from multibody_xval.scenarios.cases.motions import ChainMotion
from multibody_xval.scenarios.catalogue.chains.spectra import (
    Transmissibility,
    stationary_transmissibility,
    transient_transmissibility,
)
from multibody_xval.scenarios.catalogue.scenario import Exact, Number, Quantity, Scenario, largest, steps_a_row
from multibody_xval.scenarios.model import Case, Result, Run
from reference_lcp.chain.drives import HarmonicBase, MovingBase
from reference_lcp.chain.linear_response import frictionless_response, stuck_response
from reference_lcp.chain.transient import QUIET, FilteredNoise, RickerPulse, SweptSine
from reference_lcp.defaults import BASE_AMPLITUDE
from reference_lcp.observables.transmittance import decibel
from reference_lcp.validation import FloatArray

RATIOS: dict[str, Any] = {"damping_ratio": 0.05, "inner_damping_ratio": 0.02}
"""The paper's chain with dashpots that let a transient die out: to 1 % of its peak in 300 periods 2π / ω_r."""

RESONATOR_FREQUENCY = Case(friction_ratio=0.0, frequency_ratio=1.0).chain.resonator_frequency
"""ω_r [rad/s], whatever the friction."""

PERIOD = 2 * math.pi / RESONATOR_FREQUENCY
"""2π / ω_r [s]."""

ROWS_PER_PERIOD = 10
"""Rows kept to a period 2π / ω_r: spectra reach five times ω_r, where the chain lets nothing pass any more."""

STEPS_A_ROW = 20
"""Which makes 200 steps to a period 2π / ω_r."""

BANDS = {
    "0.3–0.6": (0.3, 0.6),
    "0.65–0.82": (0.65, 0.82),
    "0.9–1.35": (0.9, 1.35),
    "1.5–2": (1.5, 2.0),
}
"""Bands of η_r in which transmissibility is read.

Without friction, and with the dashpots of figure 3, the band of attenuation is 0.853 to 1.414: the third band lies
within, the first and the last outside; the second is where friction widens the attenuation to, or takes it back. The
dashpots of this chain round the edges off, and leave the third band below −35 dB.
"""


@cache
def base_rows(case: ChainMotion) -> FloatArray:
    """Displacement of the base at the rows of a motion, over its scale, shape (rows,)."""
    assert isinstance(case.drive, MovingBase), "the base moves"
    return case.drive.displacement(case.row_times) / case.scale


Spectrum = Callable[[FloatArray, FloatArray, float], Transmissibility]
"""Reads the transmissibility of base and response, whose rows are a time [s] apart."""


def spectral(spectrum_of: Spectrum, case: ChainMotion, response: FloatArray) -> Mapping[str, Number]:
    """Read spectra, sizes and the response itself, over the base's scale."""
    base = base_rows(case)
    spectrum = spectrum_of(base, response, PERIOD / ROWS_PER_PERIOD)
    bands = {
        f"η_r {name}": decibel(spectrum.in_band(*(RESONATOR_FREQUENCY * edge for edge in band)))
        for name, band in BANDS.items()
    }
    rms = float(np.sqrt(np.mean(response**2) / np.mean(base**2)))
    return {**bands, "rms": rms, "peak": largest(response), "series": response}


def _read(spectrum: Spectrum, name: str, result: Result, run: Run) -> Number:
    return spectral(spectrum, run.of(ChainMotion), np.array(result.series["response"]))[name]


def _effect(spectrum: Spectrum, name: str, case: ChainMotion, exact: Number) -> float:
    """Give by how much friction changes a number: its distance to the farther one of two linear chains."""
    return max(largest(spectral(spectrum, case, limit)[name] - exact) for limit in linear_limits(case))


@cache
def linear_limits(case: ChainMotion) -> list[FloatArray]:
    """Give the response with contacts that slide freely, and that never slide, by Fourier transforms."""
    import scipy.fft  # SciPy is imported once a motion is judged

    case = replace(case, friction_ratio=0.0)
    rows, chain = base_rows(case), case.chain
    length = 2 * rows.size  # what is left after the motion dies out in as long a rest
    angular_frequency = 2 * np.pi * scipy.fft.rfftfreq(length, PERIOD / ROWS_PER_PERIOD)[1:]
    spectrum = scipy.fft.rfft(rows, length)
    limits = []
    for response in (frictionless_response, stuck_response):
        passed = [response(chain, HarmonicBase(1.0, omega))[chain.cells - 1] for omega in angular_frequency.tolist()]
        limits.append(scipy.fft.irfft(np.array([1.0, *passed]) * spectrum, length)[: rows.size])
    return limits


MEANINGS = {
    **{f"η_r {name}": ("dB", "Root of the last cell's power over the base's, in this band of η_r.") for name in BANDS},
    "rms": ("", "Root mean square of the last outer mass over that of the base."),
    "peak": ("", "Largest displacement of the last outer mass over the base's scale."),
    "series": ("", "Largest difference of the last outer mass at any time, over the base's scale."),
}


def read_by(spectrum: Spectrum) -> tuple[Quantity, ...]:
    """Give what is read of a response, its spectra in this way."""
    return tuple(
        Quantity(
            name=name, unit=unit, meaning=meaning, read=partial(_read, spectrum, name), exact=Exact.LADDER,
            effect=partial(_effect, spectrum, name), accuracy="transmittance",
        )
        for name, (unit, meaning) in MEANINGS.items()
    )  # fmt: skip


def followed(drive: MovingBase, periods: int, friction_ratios: tuple[float, ...]) -> dict[str, ChainMotion]:
    """Give a base motion under several frictions, followed for so many periods 2π / ω_r."""
    return {
        f"μλ_N/(k_c U0) = {friction:g}": ChainMotion(
            friction_ratio=friction, drive=drive, time=periods * PERIOD, rows=periods * ROWS_PER_PERIOD, **RATIOS
        )
        for friction in friction_ratios
    }


RICKER_PULSE = Scenario(
    name="ricker-pulse",
    question="How much of a Ricker pulse of the base, with its peak at ω_r, arrives at the end of the chain?",
    expects="the reference at up to eight times the steps, extrapolated, its time series row by row; of presets that "
    "share the scheme the reference at equal steps",
    source="Spectra: Bendat and Piersol, Random Data, chapters 6 and 9; chain: figure 3 of Sethi, Banerjee and Manna "
    "with ζ = 0.05, and 0.02 of the resonators.",
    cases=followed(
        RickerPulse(BASE_AMPLITUDE, RESONATOR_FREQUENCY, QUIET / RESONATOR_FREQUENCY), 300, (0.0, 0.03, 0.1)
    ),
    quantities=read_by(transient_transmissibility),
    steps=steps_a_row(STEPS_A_ROW),
)
"""A pulse that is strong for its friction loses more below the attenuation band; a weak one finds the cells locked.

Without friction the band 0.65–0.82 lets −2.4 dB pass; at the ratio 0.03 it is −4.8 dB, at 0.1 +0.8 dB.
"""

SWEEP, REST = 250, 100
"""Periods 2π / ω_r of the sweep, and of the rest in which the chain dies out."""

SWEPT_SINE = replace(
    RICKER_PULSE,
    name="swept-sine",
    question="How much of a logarithmic sine sweep of the base, from 0.2 to 2.4 ω_r, arrives at the end of the chain?",
    cases=followed(
        SweptSine(BASE_AMPLITUDE, 0.2 * RESONATOR_FREQUENCY, 2.4 * RESONATOR_FREQUENCY, SWEEP * PERIOD),
        SWEEP + REST,
        (0.1, 0.3),
    ),
)
"""The sweep passes each band so slowly that the chain responds to one frequency at a time, as in figure 3.

Without friction the band 0.65–0.82 lets −2.2 dB pass; at the ratio 0.1 it is −7.8 dB, at 0.3 −4.7 dB.
"""

NOISE = 300
"""Length of the noise in periods 2π / ω_r; it does not repeat before."""

RISE, STARTED = 10, 50
"""Periods in which the noise comes up, and after which the initial transient has died out and spectra begin."""

SEGMENT = 80
"""Periods in a segment of Welch's average: lines of η_r are 1/80 apart, and there are five half overlapping segments.

Shorter ones flatten the resonances: by 1 dB at 50 periods, of a chain as damped as this one.
"""


def averaged(base: FloatArray, response: FloatArray, time_step: float) -> Transmissibility:
    """Average spectra over segments of the stationary part."""
    first = STARTED * ROWS_PER_PERIOD
    return stationary_transmissibility(base[first:], response[first:], time_step, SEGMENT * ROWS_PER_PERIOD)


FILTERED_NOISE = replace(
    RICKER_PULSE,
    name="filtered-noise",
    question="How much of noise of the base, flat from 0.2 to 2.4 ω_r, arrives at the end of the chain?",
    cases=followed(
        FilteredNoise(
            amplitude=BASE_AMPLITUDE, lowest_frequency=0.2 * RESONATOR_FREQUENCY,
            highest_frequency=2.4 * RESONATOR_FREQUENCY, repetition=NOISE * PERIOD, rise=RISE * PERIOD, seed=1,
        ),
        NOISE,
        (0.1, 0.3),
    ),
    quantities=read_by(averaged),
)  # fmt: skip
"""H1, cross spectrum over the base's: what of the response follows the base; what friction makes of it is left out.

Without friction the band 0.65–0.82 lets −2.5 dB pass; at the ratio 0.1 it is −6.3 dB, at 0.3 −0.3 dB again.
"""

SCENARIOS = (RICKER_PULSE, SWEPT_SINE, FILTERED_NOISE)
