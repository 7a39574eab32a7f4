"""Verdicts: agree, disagree, inconclusive, blocked."""

import math

import numpy as np
import pytest

from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.verdicts.finding import FLOOR_DB, TRANSMITTANCE, Comparison, Metric, Tolerance, Verdict
from multibody_xval.scenarios.verdicts.judge import Steps, decide, judge, metric_difference, missing

NUMBER = Metric("number", "dB", "made up")


def compared(result: Result, expected: Result, tolerance_db: float) -> Comparison:
    """Compare two steady states by a tolerance that is given."""
    gap = missing("engine", [result]) or missing("reference", [expected])
    given = Tolerance(given=tolerance_db)
    return gap or decide(TRANSMITTANCE, result.transmittance_db, expected.transmittance_db, given)


def answer(db, status="converged", **more) -> Result:
    return Result(status=status, transmittance_db=db, residual=1e-9, periods=30, **more)


@pytest.mark.parametrize(
    ("db", "verdict"),
    [(-10.0, Verdict.AGREE), (-9.981, Verdict.AGREE), (-9.979, Verdict.DISAGREE), (-10.03, Verdict.DISAGREE)],
)
def test_difference_within_the_tolerance_agrees(db, verdict) -> None:
    comparison = compared(answer(db), answer(-10.0), 0.02)
    assert comparison.verdict is verdict
    assert comparison.difference == pytest.approx(db + 10)


def test_tolerance_below_the_floor_is_the_amplitude_that_it_is_at_the_floor() -> None:
    """A change of 0.25 dB at the floor, and the same change of amplitude far below it; above it, dB are dB."""
    at_floor = 1e-3 * (10 ** (0.25 / 20) - 1)
    for level in (-60.0, -100.0):
        more = 20 * math.log10(10 ** (level / 20) + at_floor)
        assert metric_difference(TRANSMITTANCE, more, level) == pytest.approx(0.25, rel=0.02)
    assert metric_difference(TRANSMITTANCE, -58.75, -59.0) == pytest.approx(0.25)
    assert TRANSMITTANCE.scaled(FLOOR_DB - 1e-9) == pytest.approx(FLOOR_DB - 1e-9, abs=1e-12)
    assert TRANSMITTANCE.scaled(-math.inf) == pytest.approx(FLOOR_DB - 20 / math.log(10))


def test_no_steady_state_is_inconclusive_and_says_whose() -> None:
    stuck = answer(-10.0, status="period limit")
    for own, other, whose in ((stuck, answer(-10.0), "engine"), (answer(-10.0), stuck, "reference")):
        comparison = compared(own, other, 0.02)
        assert comparison.verdict is Verdict.INCONCLUSIVE
        assert comparison.reason.startswith(f"{whose}: period limit after 30 periods")


@pytest.mark.parametrize(
    ("multiple", "ending"), [(1, "residual 1.0e-09"), (3, ", period 3"), (0, ", no period up to 8")]
)
def test_motion_without_a_steady_state_is_named_by_its_own_period(multiple: int, ending: str) -> None:
    late = answer(-10.0, status="period limit", multiple=multiple)
    assert compared(late, answer(-10.0), 0.02).reason.endswith(ending)


def test_missing_engine_is_blocked_with_its_reason() -> None:
    comparison = compared(Result.blocked("not installed:\n no wheel"), answer(-10.0), 0.02)
    assert comparison.verdict is Verdict.BLOCKED
    assert comparison.reason == "not installed: no wheel"


def values(first, second, steps=(1.0, 0.5, 0.25)):
    """A scheme whose error has parts of the first and of the second order."""
    return [-3.0 + first * step + second * step**2 for step in steps]


def test_estimate_from_two_steps_covers_a_first_order_error() -> None:
    coarse, fine, _ = values(0.1, 0.0)
    assert abs(fine + 3.0) < Steps({400: coarse, 800: fine}).error(NUMBER) < 1.3 * abs(fine + 3.0)


def test_a_number_with_one_step_has_no_error_of_its_own() -> None:
    assert Steps({400: -3.0}).error(NUMBER) == 0.0
    assert judge(NUMBER, Steps({400: -3.0}), -3.0).verdict is Verdict.AGREE
    assert judge(NUMBER, Steps({400: -3.0}), -2.9).verdict is Verdict.DISAGREE


def test_why_there_is_no_number_is_the_verdict() -> None:
    gap = Comparison(Verdict.BLOCKED, "no wheel")
    assert judge(NUMBER, gap, 1.0) is gap


def test_of_arrays_the_largest_difference_is_judged_by_the_largest_error() -> None:
    own = Steps({1: np.array([0.0, 0.4]), 2: np.array([0.0, 0.2])})
    comparison = judge(NUMBER, own, np.array([0.24, 0.0]))
    assert (comparison.difference, comparison.tolerance) == pytest.approx((0.24, 1.25 * 0.2))
    assert comparison.verdict is Verdict.AGREE
    assert judge(NUMBER, own, np.array([0.26, 0.0])).verdict is Verdict.DISAGREE


def test_verdict_names_the_largest_part_of_what_is_allowed() -> None:
    tolerance = Tolerance(reference=0.1, engine=0.2, resolution=0.05, scheme=0.15)
    assert tolerance.allowed == pytest.approx(0.35)
    assert decide(NUMBER, 1.34, 1.0, tolerance).verdict is Verdict.AGREE
    comparison = decide(NUMBER, 0.64, 1.0, tolerance)
    assert comparison.verdict is Verdict.DISAGREE
    assert comparison.reason == "difference -0.36 dB, allowed 0.35, mostly the engine's own step (0.2)"
    lucky = Tolerance(reference=0.1, engine=0.0, resolution=0.05, scheme=0.15)
    assert "mostly the error of the reference's scheme at this step (0.15)" in str(lucky)


def test_nothing_to_compare_is_inconclusive() -> None:
    assert decide(NUMBER, math.nan, 1.0, Tolerance(reference=0.1, engine=0.1)).verdict is Verdict.INCONCLUSIVE
    assert decide(NUMBER, 1.0, 1.0, Tolerance(reference=math.nan, engine=0.1)).verdict is Verdict.INCONCLUSIVE


@pytest.mark.parametrize(
    ("error", "difference", "verdict"),
    [
        (0.9, 0.5, Verdict.AGREE),
        (1.1, 0.5, Verdict.TOO_COARSE),
        (1.1, 0.0, Verdict.TOO_COARSE),
        (1.1, 1.2, Verdict.DISAGREE),
    ],
)
def test_a_step_that_leaves_open_a_tenth_of_what_friction_changes_shows_nothing(error, difference, verdict) -> None:
    comparison = decide(NUMBER, -20.0 + difference, -20.0, Tolerance(engine=error), effect=10.0)
    assert comparison.verdict is verdict
    assert ("of 10 dB that friction changes at all" in comparison.reason) is (verdict is Verdict.TOO_COARSE)


def test_an_error_bar_or_a_residual_is_no_step() -> None:
    assert decide(NUMBER, 0.0, 0.0, Tolerance(reference=5.0, resolution=5.0), effect=1.0).verdict is Verdict.AGREE


VALUE, TIME, CREEP = (
    Metric("value", "", "of one"),
    Metric("time", "T_r", "to rest"),
    Metric("creep", "", "", effect=2.0),
)


@pytest.mark.parametrize(
    ("metric", "value", "expected", "step"),
    [(VALUE, 1.67, 1.0, 1.67), (TIME, 8.18, 3.47, 9.98), (NUMBER, -15.1, -8.4, 14.6), (CREEP, 0.3, 0.0, 0.4)],
    ids=["wear power", "time to rest", "spectrum", "creep"],
)
def test_without_an_effect_a_step_may_leave_open_a_tenth_of_the_size(metric, value, expected, step) -> None:
    """In dB the size is that of the amplitude; a metric states it where zero is expected."""
    coarse = decide(metric, value, expected, Tolerance(engine=step))
    assert coarse.verdict is Verdict.TOO_COARSE
    fine = 0.01 * (value - expected)
    assert decide(metric, expected + fine, expected, Tolerance(scheme=2 * abs(fine))).verdict is Verdict.AGREE
    assert decide(metric, value, expected, Tolerance(engine=abs(fine))).verdict is Verdict.DISAGREE


def test_beside_an_expected_zero_no_error_of_a_step_is_small() -> None:
    assert decide(VALUE, 1e-9, 0.0, Tolerance(engine=1e-9)).verdict is Verdict.TOO_COARSE
    assert decide(VALUE, 1e-9, 0.0, Tolerance(resolution=1e-9)).verdict is Verdict.AGREE


def test_size_of_a_series_is_its_largest_entry() -> None:
    series = np.array([0.0, 2.0, -4.0])
    assert decide(VALUE, series, series, Tolerance(engine=0.39)).verdict is Verdict.AGREE
    comparison = decide(VALUE, series, series, Tolerance(engine=0.41))
    assert comparison.verdict is Verdict.TOO_COARSE
    assert comparison.reason.endswith("of 4 that is expected")
