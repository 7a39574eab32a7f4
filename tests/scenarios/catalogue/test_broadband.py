"""Broadband and transient base motions: friction's effect on them, engines that are right and wrong."""

from dataclasses import replace

import numpy as np
import pytest

from multibody_xval.scenarios.cases.motions import ChainMotion
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.chains.broadband import (
    BANDS,
    FILTERED_NOISE,
    RICKER_PULSE,
    ROWS_PER_PERIOD,
    SWEPT_SINE,
    base_rows,
    followed,
    linear_limits,
)
from multibody_xval.scenarios.edges.finding import brackets
from multibody_xval.scenarios.model import REFERENCE, Case, Run
from multibody_xval.scenarios.ruler.judge import AGREES
from reference_lcp import HarmonicBase, decibel, frictionless_transmittance
from tests.scenarios.in_this_process import OTHER, SHARES, deviating, judged, judged_copy, result_of

BELOW, WITHIN, ABOVE = "η_r 0.65–0.82", "η_r 0.9–1.35", "η_r 1.5–2"

PULSE = RICKER_PULSE.cases["μλ_N/(k_c U0) = 0.03"]

SHORT_PULSE = replace(RICKER_PULSE, cases=followed(PULSE.drive, 60, (0.03,)))
"""The pulse, not followed to its end."""


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


@pytest.mark.parametrize("scenario", [RICKER_PULSE, FILTERED_NOISE], ids=lambda each: each.name)
def test_linear_limits_are_the_motions_without_friction_and_with_far_too_much(scenario) -> None:
    """To a twentieth of the peak: the noise is cut off at its end, and an effect needs no more."""
    for ratio, limit in zip((0.0, 1000.0), linear_limits(first(scenario)), strict=True):
        simulated = numbers_at(scenario, ratio)
        assert np.max(np.abs(simulated["series"] - limit)) < 0.05 * np.max(np.abs(limit))


def test_slow_sweep_meets_the_attenuation_of_figure_3() -> None:
    """While it passes a band the base is harmonic: wider up to some friction ratio, and gone when cells lock."""
    none, some, more, locked = (numbers_at(SWEPT_SINE, ratio)[BELOW] for ratio in (0.0, 0.1, 0.3, 3.0))
    assert some < none - 4
    assert more < none - 2
    assert locked > none + 4


def test_response_is_in_proportion_to_the_base_where_friction_is_too() -> None:
    """Coulomb friction has no scale of its own: twice the base, twice the bound, twice the motion."""
    (weak,) = followed(PULSE.drive, 30, (0.05,)).values()
    strong = replace(weak, drive=replace(weak.drive, amplitude=0.02), friction_ratio=0.1)
    responses = [np.array(result_of(Run(REFERENCE, own, 5 * own.rows)).series["response"]) for own in (weak, strong)]
    assert responses[1] == pytest.approx(responses[0], abs=1e-12)


@pytest.mark.parametrize("name", ["ricker-pulse", "swept-sine", "record"])
def test_transients_have_died_out_at_their_end(name) -> None:
    case = replace(first(SCENARIOS[name]), friction_ratio=0.0)
    response = np.abs(result_of(Run(REFERENCE, case, 10 * case.rows)).series["response"])
    assert np.max(response[-ROWS_PER_PERIOD * 10 :]) < 0.02 * np.max(response)
    assert np.max(np.abs(base_rows(case)[-ROWS_PER_PERIOD * 90 :])) < 1e-9


@pytest.mark.needs("mujoco")
def test_mujoco_agrees_with_the_reference_at_equal_steps() -> None:
    table = judged(SHORT_PULSE, SHARES)
    assert table.quantity.tolist() == [own.name for own in RICKER_PULSE.quantities]
    assert set(table.verdict) == {AGREES}
    series = table.set_index("quantity").loc["series"]
    assert 0 < series.value < 0.002
    assert series.distance < 1e-10


@pytest.mark.parametrize("config", [SHARES, OTHER])
def test_friction_that_is_too_large_by_a_twentieth_shows_in_the_series(config) -> None:
    table = judged_copy(SHORT_PULSE, config, lambda case: replace(case, friction_ratio=1.05 * case.friction_ratio))
    assert {quantity for _, quantity in deviating(table)} >= {"series", "peak"}


def test_the_first_two_bands_lie_below_the_attenuation_the_third_within_it_the_last_above() -> None:
    chain, eta = Case(friction_ratio=0.0, frequency_ratio=1.0).chain, np.linspace(0.3, 2.0, 1701)
    levels = [decibel(frictionless_transmittance(chain, HarmonicBase.from_ratio(chain, own))) for own in eta]
    found = brackets(np.array(levels))
    lower, upper = eta[found["lower"]], eta[found["upper"] + 1]
    assert (lower, upper) == pytest.approx((0.853, 1.414), abs=0.002)
    (_, first), (second, below), (begin, end), (above, _) = BANDS.values()
    assert first < second < below < lower < begin < end < upper < above
