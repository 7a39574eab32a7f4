"""Broadband and transient base motions: what of them arrives at the end of the chain, by spectra.

Two motions under one drive never drift apart while the normal force is given (friction is monotone), so that
errors of the steps before do not grow, and time series are compared as they are, over the whole motion.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import cache, partial

import numpy as np

from multibody_xval.scenarios.catalogue.scenario import Exact, Number, Quantity, Scenario, largest, steps_a_row
from multibody_xval.scenarios.model import AnyCase, Case, ChainMotion, Result, Run
from reference_lcp.chain.drives import HarmonicBase, MovingBase
from reference_lcp.chain.linear_response import frictionless_response, stuck_response
from reference_lcp.chain.transient import QUIET, RickerPulse
from reference_lcp.defaults import BASE_AMPLITUDE
from reference_lcp.observables.transmittance import decibel, transient_transmissibility
from reference_lcp.validation import FloatArray

RATIOS = {"damping_ratio": 0.05, "inner_damping_ratio": 0.02}
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


def chain_motion(case: AnyCase) -> ChainMotion:
    """Give the case, which is the motion of a chain."""
    assert isinstance(case, ChainMotion), "the motion of a chain"
    return case


@cache
def base_rows(case: ChainMotion) -> FloatArray:
    """Displacement of the base at the rows of a motion, over its scale, shape (rows,)."""
    assert isinstance(case.drive, MovingBase), "the base moves"
    return case.drive.displacement(case.row_times) / case.scale


def spectral(case: ChainMotion, response: FloatArray) -> Mapping[str, Number]:
    """Read spectra, sizes and the response itself, over the base's scale."""
    base = base_rows(case)
    spectrum = transient_transmissibility(base, response, PERIOD / ROWS_PER_PERIOD)
    bands = {
        f"η_r {name}": decibel(spectrum.in_band(*(RESONATOR_FREQUENCY * edge for edge in band)))
        for name, band in BANDS.items()
    }
    rms = float(np.sqrt(np.mean(response**2) / np.mean(base**2)))
    return {**bands, "rms": rms, "peak": largest(response), "series": response}


def _read(name: str, result: Result, run: Run) -> Number:
    return spectral(chain_motion(run.case), np.array(result.series["response"]))[name]


def _effect(name: str, case: AnyCase, exact: Number) -> float:
    """Give by how much friction changes a number: its distance to the farther one of two linear chains."""
    return max(largest(limit[name] - exact) for limit in linear_limits(chain_motion(case)))


@cache
def linear_limits(case: ChainMotion) -> list[Mapping[str, Number]]:
    """Give the numbers with contacts that slide freely, and that never slide, by Fourier transforms."""
    import scipy.fft  # SciPy is imported once a motion is judged

    case = replace(case, friction_ratio=0.0)
    rows, chain = base_rows(case), case.chain
    length = 2 * rows.size  # what is left after the motion dies out in as long a rest
    angular_frequency = 2 * np.pi * scipy.fft.rfftfreq(length, PERIOD / ROWS_PER_PERIOD)[1:]
    spectrum = scipy.fft.rfft(rows, length)
    limits = []
    for response in (frictionless_response, stuck_response):
        passed = [response(chain, HarmonicBase(1.0, omega))[chain.cells - 1] for omega in angular_frequency.tolist()]
        motion = scipy.fft.irfft(np.array([1.0, *passed]) * spectrum, length)[: rows.size]
        limits.append(spectral(case, motion))
    return limits


MEANINGS = {
    **{f"η_r {name}": ("dB", "Root of the last cell's power over the base's, in this band of η_r.") for name in BANDS},
    "rms": ("", "Root mean square of the last outer mass over that of the base."),
    "peak": ("", "Largest displacement of the last outer mass over the base's scale."),
    "series": ("", "Largest difference of the last outer mass at any time, over the base's scale."),
}

QUANTITIES = tuple(
    Quantity(
        name=name, unit=unit, meaning=meaning, read=partial(_read, name), exact=Exact.LADDER,
        effect=partial(_effect, name), accuracy="transmittance",
    )
    for name, (unit, meaning) in MEANINGS.items()
)  # fmt: skip

EXPECTS = (
    "the reference at up to eight times the steps, extrapolated, its time series row by row; of presets that share the "
    "scheme the reference at equal steps"
)


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
    expects=EXPECTS,
    source="Spectra: Bendat and Piersol, Random Data, chapters 6 and 9; chain: figure 3 of Sethi, Banerjee and Manna "
    "with ζ = 0.05, and 0.02 of the resonators.",
    cases=followed(
        RickerPulse(BASE_AMPLITUDE, RESONATOR_FREQUENCY, QUIET / RESONATOR_FREQUENCY), 300, (0.0, 0.03, 0.1)
    ),
    quantities=QUANTITIES,
    steps=steps_a_row(STEPS_A_ROW),
)
"""A pulse that is strong for its friction loses more below the attenuation band; a weak one finds the cells locked.

Without friction the band 0.65–0.82 lets −2.4 dB pass; at the ratio 0.03 it is −4.8 dB, at 0.1 +0.8 dB.
"""

SCENARIOS = (RICKER_PULSE,)
