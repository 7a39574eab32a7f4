"""Short questions about one block: exact answers in closed form, and engines that get them wrong."""

import numpy as np
import pytest

from multibody_xval.engines.interface.presets import LARGEST_ACCURACY
from multibody_xval.scenarios.catalogue.blocks import block, breakaway, held, published, thrown
from multibody_xval.scenarios.catalogue.blocks.breakaway import BREAKAWAY
from multibody_xval.scenarios.catalogue.blocks.held import STATIC_HOLD
from multibody_xval.scenarios.catalogue.blocks.thrown import STOPPING_DISTANCE
from multibody_xval.scenarios.model import EXACT, REFERENCE, Config, Run
from multibody_xval.scenarios.ruler.judge import DEVIATES
from reference_lcp.defaults import FRICTION_COEFFICIENT
from tests.scenarios.in_this_process import OTHER, SHARES, deviating, judged, judged_copy, only, pressed, result_of

both = pytest.mark.parametrize("config", [SHARES, OTHER])


def read_of(scenario, case, run):
    """What a scenario reads of a run, by quantity."""
    return {own.name: own.read(result_of(run), run) for own in scenario.quantities}


def block_cases(scenario):
    return [pytest.param(case, id=name) for name, case in scenario.cases.items()]


@pytest.mark.parametrize("case", block_cases(STOPPING_DISTANCE))
def test_exact_block_stops_after_half_of_its_velocity_squared_over_the_deceleration(case) -> None:
    """v² / (2 μ λ_N / m) but for the spring, 1e-4 of the bound at the end, and the carrier, of 20 blocks."""
    numbers = read_of(STOPPING_DISTANCE, case, Run(EXACT, case, case.rows))
    assert numbers["distance"] == pytest.approx(1, abs=1e-3)
    assert numbers["time"] == pytest.approx(1 - np.sqrt(1e-3), abs=2 * thrown.FOLLOWED / case.rows)
    deceleration = case.block.normal_force / case.block.mass * FRICTION_COEFFICIENT
    assert case.scale == pytest.approx(case.slip_velocity**2 / (2 * deceleration))


@pytest.mark.parametrize("case", block_cases(STATIC_HOLD))
def test_scheme_holds_every_load_below_the_bound_without_any_slip(case) -> None:
    """The reference's own vibration does not reach the bound either, or it would slip."""
    slip = np.array(result_of(Run(REFERENCE, case, 50 * case.rows)).series["slip"])
    assert np.max(np.abs(slip * held.SIZE - case.slip)) < 1e-13


@pytest.mark.parametrize("case", block_cases(BREAKAWAY))
def test_scheme_breaks_away_as_the_closed_form_says(case) -> None:
    """At equal steps within two of them; with 16 times as many at the same row."""
    time, fine = (breakaway.slip_time(result_of(run), run) for run in
                  (Run(REFERENCE, case, factor * case.rows) for factor in (1, 16)))  # fmt: skip
    exact = breakaway.exact_slip_time(case)
    assert time == pytest.approx(exact, abs=2 * case.time / case.rows)
    assert fine == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("own", published.NUMBERS.values(), ids=lambda own: own.name)
def test_exact_block_on_a_free_carrier_gives_the_published_number(own) -> None:
    """So that the carrier costs no more than the digits that are printed, and the reading."""
    run, expected = Run(EXACT, own.case, own.steps), own.value / own.over
    left = published.MORE_LEFT.get(own.name, published.LEFT)
    assert abs(published.read(result_of(run), run) - expected) <= published.left_open(run)
    assert left < 1e-3 * abs(expected) or own.name == "sdnd104-0.99"


@pytest.mark.needs("mujoco")
def test_the_soft_friction_of_mujoco_drifts_by_its_constants() -> None:
    soft = Config("mujoco", "joint", "default")
    table = judged(only(STATIC_HOLD, "1 kg, load 0.5"), soft)
    drift = table[table.quantity == "drift"].set_index("case")
    assert set(drift.verdict) == {DEVIATES}
    assert not drift.judged.any()
    # μ g / 2 over the rate 2 / (d_max τ) of the constraint, softened by (1 − d_0) / d_0: 2.72 mm/s, and the spring
    # relaxes with it
    rate, softness = 2 / (0.95 * 0.02), (1 - 0.9) / 0.9
    first = softness / rate * FRICTION_COEFFICIENT * block.STANDARD_GRAVITY / 2 * (1 + 1 / 20)
    relaxed = np.exp(-first / (0.5 * held.LENGTH) * 0.75 * held.HOLD_TIME)
    assert drift.value["1 kg, load 0.5"] == pytest.approx(1e6 * first * relaxed, rel=1e-3)


@both
@pytest.mark.parametrize("factor", [0.99, 1.01])
def test_friction_that_is_a_hundredth_off_breaks_away_elsewhere_and_stops_elsewhere(config, factor) -> None:
    table = judged_copy(only(BREAKAWAY, "1 g"), config, pressed(factor))
    (fine,) = table[table.case == "1 g, 0.5 ms"].itertuples()
    assert (fine.verdict, np.sign(fine.error)) == (DEVIATES, np.sign(factor - 1))
    stopped = judged_copy(only(STOPPING_DISTANCE, "1 g"), config, pressed(factor))
    distance = stopped[stopped.quantity == "distance"]
    assert (distance.verdict == DEVIATES).all()
    assert np.sign(distance.error.astype(float)).tolist() == 2 * [np.sign(1 - factor)]


@both
def test_a_bound_that_is_two_hundredths_too_small_does_not_hold_the_largest_load(config) -> None:
    off = deviating(judged_copy(only(STATIC_HOLD, "1 kg"), config, pressed(0.98)))
    assert {case for case, _ in off} == {"1 kg, load 0.99", "1 kg, load 0.99, shaken"}


@both
@pytest.mark.parametrize(("factor", "held"), [(0.97, set()), (1.03, {"sdnd104-0.99"})])
def test_friction_that_is_off_gives_other_numbers_than_those_published(config, factor, held) -> None:
    """Three hundredths less, and the block slips on the table that was not to move it."""
    off = {case for case, _ in deviating(judged_copy(published.PUBLISHED, config, pressed(factor)))}
    assert off == set(published.PUBLISHED.cases) - held


@pytest.mark.parametrize("factor", [0.99, 1.01])
def test_a_bound_that_is_a_hundredth_off_is_found_there_beside_the_largest_accuracy_that_is_stated(factor) -> None:
    stated = Config("exudyn-regularised", "contact")
    assert stated.preset.accuracy_of("transmittance") == LARGEST_ACCURACY
    (row,) = judged_copy(only(published.PUBLISHED, "sdnd104-1.01"), stated, pressed(factor)).itertuples()
    assert row.verdict == DEVIATES
    assert row.distance > 5 * row.allowed
