"""Transmissibility by spectra: in the linear limit it is the transmittance of the harmonic base."""

import numpy as np
import pytest

from multibody_xval.scenarios.catalogue.chains.spectra import stationary_transmissibility, transient_transmissibility
from reference_lcp import (
    Chain,
    FilteredNoise,
    HarmonicBase,
    ParameterError,
    RickerPulse,
    decibel,
    frictionless_transmittance,
    simulate,
    stuck_transmittance,
)

PERIODS = 150
ROWS = 20


def spectrum_of_pulse(chain, steps_per_period):
    """Transmissibility of a pulse that has died out at the end, from rows that are equally far apart."""
    omega = chain.resonator_frequency
    pulse = RickerPulse(0.01, omega, 10 / omega)
    step = 2 * np.pi / omega / steps_per_period
    run = simulate(chain, pulse, time_step=step, steps=PERIODS * steps_per_period)
    every = slice(steps_per_period // ROWS - 1, None, steps_per_period // ROWS)
    response = run.outer_positions[every, -1]
    assert np.max(np.abs(response[-ROWS:])) < 1e-3 * np.max(np.abs(response)), "it has not died out"
    base = pulse.displacement(run.time[every])
    return transient_transmissibility(base, response, step * steps_per_period / ROWS)


@pytest.mark.parametrize(
    ("friction_ratio", "theory"), [(0.0, frictionless_transmittance), (20.0, stuck_transmittance)]
)  # fmt: skip
def test_pulse_in_a_linear_chain_shows_the_transmittance_at_every_frequency(friction_ratio, theory) -> None:
    """The scheme is of first order: extrapolated from two step sizes, what is left is of second."""
    chain = Chain.from_ratios(cells=3, damping_ratio=0.1, inner_damping_ratio=0.05, friction_ratio=friction_ratio)
    coarse, fine = (spectrum_of_pulse(chain, steps) for steps in (200, 400))
    omega = chain.resonator_frequency
    inside = (fine.angular_frequency > 0.3 * omega) & (fine.angular_frequency < 2 * omega)
    estimate = 2 * np.abs(fine.ratio[inside]) - np.abs(coarse.ratio[inside])
    expected = [theory(chain, HarmonicBase(0.01, line)) for line in fine.angular_frequency[inside]]
    assert estimate == pytest.approx(expected, rel=2e-3, abs=1e-4)


def test_noise_in_a_linear_chain_shows_the_transmittance_of_a_band() -> None:
    """All of the response follows the base: what is left is Welch's bias, within 0.3 dB where lines are 1/150 apart."""
    chain = Chain.from_ratios(cells=2, damping_ratio=0.2, inner_damping_ratio=0.1)
    omega = chain.resonator_frequency
    period = 2 * np.pi / omega
    noise = FilteredNoise(0.01, 0.2 * omega, 2.5 * omega, 400 * period, 5 * period)
    run = simulate(chain, noise, time_step=period / 100, steps=400 * 100)
    rows = slice(4999, None, 5)
    base, response = noise.displacement(run.time[rows]), run.outer_positions[rows, -1]
    estimate = stationary_transmissibility(base, response, period / 20, 150 * 20)
    for lowest, highest in ((0.3, 0.6), (0.9, 1.35), (1.5, 2.0)):
        inside = (estimate.angular_frequency > lowest * omega) & (estimate.angular_frequency < highest * omega)
        lines = estimate.angular_frequency[inside]
        squares = [frictionless_transmittance(chain, HarmonicBase(0.01, line)) ** 2 for line in lines]
        expected = decibel(np.sqrt(np.average(squares, weights=estimate.base_power[inside])))
        assert decibel(estimate.in_band(lowest * omega, highest * omega)) == pytest.approx(expected, abs=0.3)


def test_what_does_not_follow_the_base_is_left_out_of_h1() -> None:
    """Noise at the response averages out of the cross spectrum; in a ratio of powers it would count."""
    rng = np.random.default_rng(1)
    base, noise = rng.normal(size=(2, 200_000))
    estimate = stationary_transmissibility(base, 0.5 * base + noise, 0.01, 256)
    assert estimate.in_band(20.0, 200.0) == pytest.approx(0.5, rel=0.02)


def test_band_without_power_has_no_number_and_what_gives_no_spectrum_is_refused() -> None:
    still = np.zeros(2000)
    estimate = transient_transmissibility(still, np.sin(0.01 * np.arange(2000)), 0.01)
    assert np.isnan(estimate.in_band(1.0, 10.0))
    with pytest.raises(ParameterError, match=r"holds 1 lines of the spectrum; allowed: at least 3"):
        estimate.in_band(1.0, 1.3)
    with pytest.raises(ParameterError, match=r"shapes \(5,\) and \(4,\); allowed: both"):
        transient_transmissibility(still[:5], still[:4], 0.1)
    with pytest.raises(ParameterError, match="segment = 60 of 100 samples; allowed: at most half"):
        stationary_transmissibility(still[:100], still[:100], 0.1, 60)
