"""Decays, pulses, sweeps, noise and records: what friction does to them, in closed form, and what is wrong of them."""

import math
from dataclasses import replace

import numpy as np
import pytest

from multibody_xval.scenarios.cases.motions import ChainMotion
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.blocks.published import PUBLISHED
from multibody_xval.scenarios.catalogue.blocks.static_friction import STATIC_ABOVE_KINETIC
from multibody_xval.scenarios.catalogue.blocks.thrown import STOPPING_DISTANCE
from multibody_xval.scenarios.catalogue.chains import broadband, free_decay
from multibody_xval.scenarios.catalogue.chains.long_run import LONG_RUN
from multibody_xval.scenarios.catalogue.chains.record_file import read_record
from multibody_xval.scenarios.catalogue.chains.records import EXAMPLE, RECORD, following
from multibody_xval.scenarios.catalogue.numbers import numbers
from multibody_xval.scenarios.catalogue.scenario import steps_a_row
from multibody_xval.scenarios.model import EXACT, REFERENCE, Result, Run
from multibody_xval.scenarios.ruler.judge import AGREES, DEVIATES, TOO_LARGE
from multibody_xval.scenarios.store import Stored
from reference_lcp import ParameterError, RecordedBase
from tests.scenarios.catalogue.example_record import PEAK, example_samples
from tests.scenarios.in_this_process import OTHER, SHARES, judged, judged_copy, only, result_of

BELOW, WITHIN, ABOVE = "η_r 0.65–0.82", "η_r 0.9–1.35", "η_r 1.5–2"

PULSE = broadband.RICKER_PULSE.cases["μλ_N/(k_c U0) = 0.03"]

SHORT_PULSE = replace(broadband.RICKER_PULSE, cases=broadband.followed(PULSE.drive, 60, (0.03,)))
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


@pytest.mark.parametrize("name", ["ricker-pulse", "swept-sine", "record"])
def test_transients_have_died_out_at_their_end(name) -> None:
    case = replace(first(SCENARIOS[name]), friction_ratio=0.0)
    response = np.abs(result_of(Run(REFERENCE, case, 10 * case.rows)).series["response"])
    assert np.max(response[-broadband.ROWS_PER_PERIOD * 10 :]) < 0.02 * np.max(response)


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


@pytest.mark.needs("mujoco")
@pytest.mark.parametrize("scenario", [SHORT_PULSE, free_decay.FREE_DECAY], ids=lambda own: own.name)
def test_mujoco_agrees_with_the_reference_at_equal_steps(scenario) -> None:
    assert set(judged(scenario, SHARES).verdict) == {AGREES}


def stretched(part: float):
    """Stretch all series by a part."""

    def spoil(result: Result) -> Result:
        series = {name: tuple((1 + part) * number for number in own) for name, own in result.series.items()}
        return replace(result, series=series)

    return spoil


MOTIONS = [
    *(
        replace(own, cases=dict([*own.cases.items()][:1]))
        for own in (PUBLISHED, free_decay.FREE_DECAY, STOPPING_DISTANCE)
    ),
    SHORT_PULSE,
    only(STATIC_ABOVE_KINETIC, "1 kg, 1.5"),
]


@pytest.mark.parametrize("config", [SHARES, OTHER])
@pytest.mark.parametrize("scenario", MOTIONS, ids=lambda own: own.name)
def test_a_motion_that_is_stretched_by_a_half_deviates(scenario, config) -> None:
    assert DEVIATES in set(judged_copy(scenario, config, spoil=stretched(0.5)).verdict)


@pytest.mark.parametrize(("config", "part"), [(SHARES, 1e-6), (OTHER, 0.05)])
def test_a_long_run_that_is_off_by_a_millionth_deviates_at_equal_steps(config, part) -> None:
    """It is 640 times as long as a period of the contract, and round-off grows as the root of the number of steps."""
    assert set(judged_copy(LONG_RUN, config).verdict) == {AGREES}
    assert set(judged_copy(LONG_RUN, config, spoil=stretched(part)).verdict) == {DEVIATES}


def test_a_time_step_that_leaves_out_what_friction_does_shows_nothing() -> None:
    table = judged_copy(replace(only(free_decay.FREE_DECAY, "inner"), steps=steps_a_row(1)), OTHER)
    assert set(table.verdict) == {AGREES, TOO_LARGE}


def test_example_record_is_its_formula_and_small() -> None:
    assert EXAMPLE.stat().st_size < 20_000
    record, (times, displacements) = read_record(EXAMPLE), example_samples()
    assert record == RecordedBase(tuple(times.tolist()), tuple(displacements.tolist()))
    assert record.amplitude == PEAK


def test_own_record_is_scaled_and_one_that_is_missing_or_too_coarse_for_the_bands_is_refused(tmp_path) -> None:
    file = tmp_path / "own.csv"
    with pytest.raises(ParameterError, match=r"own\.csv cannot be read"):
        following(file)
    file.write_text("\n".join(f"{0.06 * k:.4f},{0.01 * math.sin(k)}" for k in range(50)))
    with pytest.raises(ParameterError, match=r"too coarse: samples are up to 0\.06 s apart; allowed: <= 0\.0496"):
        following(file)
    file.write_text("\n".join(f"{0.02 * k:.4f},{3 * math.sin(k) * math.sin(math.pi * k / 100)}" for k in range(101)))
    period = 2 * math.pi / math.sqrt(1000)
    for case in following(file).cases.values():
        assert case.scale == pytest.approx(0.01)
        assert case.time == pytest.approx((math.ceil(2.0 / period) + 200) * period)


def test_stored_results_of_a_record_are_judged_by_the_file_that_is_named() -> None:
    """A stored run knows the record by its hash alone."""
    scenario = only(RECORD, "= 0.3")
    results = [Stored(run, "1", result_of(run)) for run in scenario.runs([SHARES])]
    stored = [own._replace(run=Run.from_text(own.run.text)) for own in results]
    table = numbers(scenario, stored)
    assert set(table[table.engine == "mujoco"].verdict) == {AGREES}
    other = replace(scenario, cases={"another": replace(results[-1].run.of(ChainMotion), friction_ratio=0.2)})
    assert numbers(other, stored).empty
