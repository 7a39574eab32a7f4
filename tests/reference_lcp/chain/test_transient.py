"""Base motions in closed form and recorded ones: their velocities, their spectra, all that can be wrong."""

import re

import numpy as np
import pytest

from multibody_xval.scenarios.cases.motions import drive_data
from reference_lcp import FilteredNoise, ParameterError, RecordedBase, RickerPulse, SweptSine

PULSE = RickerPulse(0.01, 30.0, 0.4)
NOISE = FilteredNoise(0.01, 6.0, 60.0, 40.0, 2.0, seed=3)
UP = SweptSine(0.01, 5.0, 60.0, 20.0)
DOWN = SweptSine(0.01, 60.0, 5.0, 20.0, sweep="linear", taper=0.2)


@pytest.mark.parametrize("base", [PULSE, NOISE, UP, DOWN], ids=["pulse", "noise", "up", "down"])
def test_motion_begins_at_rest_and_its_velocity_is_the_derivative_of_its_displacement(base) -> None:
    """By central differences of fourth order: (h ω)⁴ / 30 of the velocity, and round-off over h, are left."""
    speed, start = 60 * base.amplitude, np.zeros(1)
    assert abs(base.displacement(start)[0]) < 1e-9 * base.amplitude
    assert abs(base.velocity(start)[0]) < 1e-8 * speed
    time, h = np.linspace(0.01, 21.0, 997), 1e-4
    near, far = (base.displacement(time + k * h) - base.displacement(time - k * h) for k in (1, 2))
    assert base.velocity(time) == pytest.approx((8 * near - far) / (12 * h), abs=1e-8 * speed)


def test_spectrum_of_the_pulse_is_rickers_and_peaks_at_its_peak_frequency() -> None:
    """|U_0(ω)| = A √(16π) / ω_p (ω/ω_p)² exp(−ω²/ω_p²), by a sum that is exact to round-off for such a pulse."""
    step, samples = 0.002, 4000
    spectrum = step * np.abs(np.fft.rfft(PULSE.displacement(step * np.arange(samples))))
    omega = 2 * np.pi * np.fft.rfftfreq(samples, step)
    relative = omega / PULSE.peak_frequency
    expected = 0.01 * np.sqrt(16 * np.pi) / PULSE.peak_frequency * relative**2 * np.exp(-(relative**2))
    assert spectrum == pytest.approx(expected, abs=1e-8 * np.max(expected))
    assert abs(omega[np.argmax(spectrum)] - PULSE.peak_frequency) <= omega[1]


@pytest.mark.parametrize(("base", "middle"), [(UP, np.sqrt(5.0 * 60.0)), (DOWN, 32.5)], ids=["logarithmic", "linear"])
def test_sweep_passes_the_frequencies_in_their_order(base, middle) -> None:
    """Half-way it is at the geometric or the arithmetic mean: turns of sin φ are there 2π / ω apart."""
    time = np.linspace(9.0, 11.0, 200_001)
    crossings = time[np.flatnonzero(np.diff(np.sign(base.displacement(time))))]
    frequency = np.pi / np.diff(crossings)
    assert np.interp(10.0, (crossings[1:] + crossings[:-1]) / 2, frequency) == pytest.approx(middle, rel=1e-3)
    assert np.all(np.diff(frequency) * (base.last_frequency - base.first_frequency) > 0)


def test_sweep_is_still_after_its_end_and_full_between_its_tapers() -> None:
    late = np.array([20.0, 25.0])
    assert np.max(np.abs(DOWN.displacement(late))) < 1e-15
    assert np.max(np.abs(DOWN.velocity(late))) < 1e-12
    assert np.max(np.abs(DOWN.displacement(np.linspace(4, 16, 20_001)))) == pytest.approx(0.01, rel=1e-4)


def test_noise_has_its_band_and_its_power_and_nothing_else() -> None:
    """Over one repetition the lines of a Fourier sum are the sines of the noise."""
    samples = 4096
    time = 40.0 + 40.0 / samples * np.arange(samples)
    lines = np.abs(np.fft.rfft(NOISE.displacement(time))) * 2 / samples
    omega = 2 * np.pi * np.fft.rfftfreq(samples, 40.0 / samples)
    inside = (omega >= 6.0) & (omega <= 60.0)
    assert lines[~inside] == pytest.approx(0, abs=1e-14)
    assert lines[inside] == pytest.approx(0.01 / np.sqrt(np.count_nonzero(inside)), rel=1e-9)


def test_noise_of_one_seed_is_the_same_at_any_times_and_that_of_another_is_not() -> None:
    time = np.linspace(0, 100, 10_001)
    alone = np.array([NOISE.displacement(time[k : k + 1])[0] for k in (7, 5000, 10_000)])
    assert NOISE.displacement(time)[[7, 5000, 10_000]] == pytest.approx(alone, abs=1e-15)
    other = FilteredNoise(0.01, 6.0, 60.0, 40.0, 2.0, seed=4)
    assert abs(np.corrcoef(NOISE.displacement(time), other.displacement(time))[0, 1]) < 0.5


RECORD = RecordedBase((1.0, 1.5, 1.7, 2.6, 3.0), (0.2, 0.3, -0.1, 0.4, 0.25))


def test_record_passes_through_its_samples_from_its_first_one_and_is_at_rest_outside() -> None:
    """Time and displacement count from the first sample; the spline is clamped, so that no velocity jumps."""
    times = np.array(RECORD.times) - 1.0
    assert RECORD.displacement(times) == pytest.approx(np.array(RECORD.displacements) - 0.2, abs=1e-15)
    assert RECORD.displacement(np.array([-1.0, 9.0])) == pytest.approx([0.0, 0.05])
    assert np.all(RECORD.velocity(np.array([-1.0, 0.0, 2.0, 3.0])) == pytest.approx(0, abs=1e-14))
    assert (RECORD.amplitude, RECORD.duration) == pytest.approx((0.3, 2.0))


def test_records_differ_in_their_parameters_where_a_sample_does() -> None:
    other = RecordedBase(RECORD.times, (*RECORD.displacements[:-1], 0.25 + 1e-15))
    assert drive_data(RECORD) != drive_data(other)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: RickerPulse(0.01, 30.0, 0.1), "delay = 0.1 s cuts off the beginning of the pulse; allowed: >= 0.333"),
        (lambda: SweptSine(0.01, 5.0, 5.0, 1.0), "last_frequency = 5; allowed: other than first_frequency"),
        (lambda: SweptSine(0.01, 5.0, 6.0, 1.0, taper=0.6), "taper = 0.6 is outside its range; allowed: > 0, <= 0.5"),
        (lambda: FilteredNoise(0.01, 6.0, 7.0, 40.0, 1.0), "repetition = 40 s gives 6 sines in the band"),
        (lambda: RecordedBase(RECORD.times, RECORD.displacements[:4]), "5 times and 4 displacements; allowed: as many"),
        (lambda: RecordedBase((0, np.nan, 1, 2), (0, 1, 2, 3)), "time in sample 2 of the record = nan"),
        (lambda: RecordedBase((0, 2, 1, 3), (0, 1, 2, 3)), "time = 1 s in sample 3 of the record; allowed: > 2 s"),
        (lambda: RecordedBase((0, 1, 2, 3), (1, 1, 1, 1)), "displacement = 1 m throughout; allowed: a base that moves"),
    ],
)
def test_base_motion_that_is_impossible_or_too_coarse_is_refused_with_the_range(make, message) -> None:
    with pytest.raises(ParameterError, match=re.escape(message)):
        make()
