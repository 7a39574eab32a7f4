"""Decays, pulses, sweeps, noise and records: what friction does to them, closed forms, and spectra."""

from dataclasses import replace

import numpy as np
import pytest

from multibody_xval.scenarios.cases.motions import ChainMotion
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.chains import broadband, free_decay
from multibody_xval.scenarios.catalogue.chains.spectra import stationary_transmissibility, transient_transmissibility
from multibody_xval.scenarios.model import EXACT, REFERENCE, Run
from reference_lcp import (
    Chain,
    HarmonicBase,
    RickerPulse,
    frictionless_transmittance,
    simulate,
    stuck_transmittance,
)
from tests.scenarios.in_this_process import result_of

BELOW, WITHIN, ABOVE = "η_r 0.65–0.82", "η_r 0.9–1.35", "η_r 1.5–2"


def first(scenario) -> ChainMotion:
    return next(iter(scenario.cases.values()))


def numbers_at(scenario, friction_ratio):
    """What the scenario reads from the reference, with 100 steps to a period."""
    run = Run(REFERENCE, replace(first(scenario), friction_ratio=friction_ratio), 10 * first(scenario).rows)
    return {own.name: own.read(result_of(run), run) for own in scenario.quantities}


@pytest.mark.parametrize("name", ["ricker-pulse", "record"])
def test_friction_attenuates_more_below_the_band_only_within_a_range_of_amplitude(name) -> None:
    """The same chain, hit ever more softly: little friction widens the attenuation, much of it locks the cells."""
    none, some, much = (numbers_at(SCENARIOS[name], ratio) for ratio in (0.0, 0.03, 0.3))
    assert some[BELOW] < none[BELOW] - 1
    assert much[BELOW] > none[BELOW] + 1
    # locked cells have no resonators: no gap, and one pass band that ends earlier
    assert none[WITHIN] < -30
    assert much[WITHIN] > -15
    assert much[ABOVE] < none[ABOVE] - 20


@pytest.mark.parametrize("scenario", [broadband.RICKER_PULSE, broadband.FILTERED_NOISE], ids=lambda each: each.name)
def test_linear_limits_are_the_motions_without_friction_and_with_far_too_much(scenario) -> None:
    """To a twentieth of the peak: the noise is cut off at its end, and an effect needs no more."""
    for ratio, limit in zip((0.0, 1000.0), broadband.linear_limits(first(scenario)), strict=True):
        simulated = numbers_at(scenario, ratio)
        assert np.max(np.abs(simulated["series"] - limit)) < 0.05 * np.max(np.abs(limit))


def test_slow_sweep_meets_the_attenuation_of_figure_3() -> None:
    """While it passes a band the base is harmonic: wider up to some friction ratio, and gone when cells lock."""
    none, some, more, locked = (numbers_at(broadband.SWEPT_SINE, ratio)[BELOW] for ratio in (0.0, 0.1, 0.3, 3.0))
    assert some < none - 4
    assert more < none - 2
    assert locked > none + 4


def test_oscillator_decays_by_the_closed_form() -> None:
    """Let go at 1, with F / k = 0.06: turns at 0.88, 0.76, … 0.04, where it stays, after eight half cycles."""
    run = Run(EXACT, free_decay.OSCILLATOR, 8 * free_decay.OSCILLATOR.rows)
    exact = result_of(run)
    assert exact.series["offsets"][0] == pytest.approx(0.04, abs=1e-4)
    assert free_decay.rest_time(exact, run) == pytest.approx(4, abs=0.03)
    assert free_decay.loss_a_cycle(np.array(exact.series["swing"])) == pytest.approx(4 * 0.06, rel=1e-4)
    # springs of the rest state hold (1/25)² of the energy
    assert exact.series["energy"][0] == pytest.approx(0.04**2, abs=2e-4)
    assert free_decay.half_width(run) == pytest.approx(0.06)


@pytest.mark.parametrize("case", free_decay.FREE_DECAY.cases.values(), ids=free_decay.FREE_DECAY.cases)
def test_contacts_come_to_rest_inside_their_dead_bands_before_the_end(case) -> None:
    run = Run(EXACT, case, 8 * case.rows)
    assert 0 < result_of(run).series["rest"][0] < 0.9 * case.time
    assert 0.01 < np.max(np.abs(free_decay.offsets(result_of(run), run))) <= 1


PERIODS = 150
ROWS = 20


def spectrum_of_pulse(chain, steps_per_period):
    """Transmissibility of a pulse that has died out at the end, from rows that are equally far apart."""
    omega, every = chain.resonator_frequency, steps_per_period // ROWS
    pulse, step = RickerPulse(0.01, omega, 10 / omega), 2 * np.pi / omega / steps_per_period
    run = simulate(chain, pulse, time_step=step, steps=PERIODS * steps_per_period)
    response = run.outer_positions[every - 1 :: every, -1]
    assert np.max(np.abs(response[-ROWS:])) < 1e-3 * np.max(np.abs(response)), "it has not died out"
    return transient_transmissibility(pulse.displacement(run.time[every - 1 :: every]), response, step * every)


@pytest.mark.parametrize(("friction_ratio", "theory"), [(0.0, frictionless_transmittance), (20.0, stuck_transmittance)])
def test_pulse_in_a_linear_chain_shows_the_transmittance_at_every_frequency(friction_ratio, theory) -> None:
    """The scheme is of first order: extrapolated from two step sizes, what is left is of second."""
    chain = Chain.from_ratios(cells=3, damping_ratio=0.1, inner_damping_ratio=0.05, friction_ratio=friction_ratio)
    coarse, fine = (spectrum_of_pulse(chain, steps) for steps in (200, 400))
    lines = fine.angular_frequency / chain.resonator_frequency
    inside = (lines > 0.3) & (lines < 2)
    estimate = 2 * np.abs(fine.ratio[inside]) - np.abs(coarse.ratio[inside])
    expected = [theory(chain, HarmonicBase(0.01, line)) for line in fine.angular_frequency[inside]]
    assert estimate == pytest.approx(expected, rel=2e-3, abs=1e-4)


def test_a_band_has_the_power_that_follows_the_base_alone() -> None:
    """Of differences of white noise |H|² = 2 − 2 cos ω; what else the response does averages out of cross spectra."""
    base, other = np.random.default_rng(1).normal(size=(2, 200_000))
    estimate = stationary_transmissibility(base, base - np.roll(base, 1) + other, 1.0, 256)
    inside = (estimate.angular_frequency > 1.0) & (estimate.angular_frequency < 2.5)
    exact = np.sqrt(np.average(2 - 2 * np.cos(estimate.angular_frequency[inside]), weights=estimate.base_power[inside]))
    assert estimate.in_band(1.0, 2.5) == pytest.approx(exact, rel=0.01)
