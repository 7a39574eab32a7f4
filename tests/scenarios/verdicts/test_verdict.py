"""Verdicts: agree, disagree, inconclusive, blocked."""

import math

import pytest

from scenarios.tasks.result import Result
from scenarios.verdicts.verdict import (
    EDGE_TOLERANCE,
    Tolerance,
    Verdict,
    allowed_difference_db,
    compare,
    compare_edge,
    compare_transmittance,
    scheme_bar,
    step_estimate,
)


def answer(db, status="converged", **more) -> Result:
    return Result(status=status, transmittance_db=db, residual=1e-9, periods=30, **more)


@pytest.mark.parametrize(
    ("db", "verdict"),
    [(-10.0, Verdict.AGREE), (-9.981, Verdict.AGREE), (-9.979, Verdict.DISAGREE), (-10.03, Verdict.DISAGREE)],
)
def test_difference_within_the_tolerance_agrees(db, verdict) -> None:
    comparison = compare_transmittance(answer(db), answer(-10.0), 0.02)
    assert comparison.verdict is verdict
    assert comparison.difference == pytest.approx(db + 10)


def test_tolerance_below_the_floor_is_the_amplitude_that_it_is_at_the_floor() -> None:
    assert allowed_difference_db(-59.0, 0.25) == pytest.approx(0.25)
    assert allowed_difference_db(-60.0, 0.25) == pytest.approx(0.25)
    at_floor = 1e-3 * (10 ** (0.25 / 20) - 1)
    deep = 10 ** (-100 / 20)
    assert allowed_difference_db(-100.0, 0.25) == pytest.approx(20 * math.log10(1 + at_floor / deep))


def test_no_steady_state_is_inconclusive_and_says_whose() -> None:
    stuck = answer(-10.0, status="period limit")
    for one, other, whose in ((stuck, answer(-10.0), "engine"), (answer(-10.0), stuck, "reference")):
        comparison = compare_transmittance(one, other, 0.02)
        assert comparison.verdict is Verdict.INCONCLUSIVE
        assert comparison.reason.startswith(f"{whose}: period limit after 30 periods")


@pytest.mark.parametrize(
    ("multiple", "ending"), [(1, "residual 1.0e-09"), (3, ", period 3"), (0, ", no period up to 8")]
)
def test_motion_without_a_steady_state_is_named_by_its_own_period(multiple: int, ending: str) -> None:
    late = answer(-10.0, status="period limit", multiple=multiple)
    assert compare_transmittance(late, answer(-10.0), 0.02).reason.endswith(ending)


def test_missing_engine_is_blocked_with_its_reason() -> None:
    comparison = compare_transmittance(Result.blocked("not installed:\n no wheel"), answer(-10.0), 0.02)
    assert comparison.verdict is Verdict.BLOCKED
    assert comparison.reason == "not installed: no wheel"


@pytest.mark.parametrize(
    ("edge", "converged", "verdict"),
    [
        (0.8, 0.8 + 0.9 * EDGE_TOLERANCE, Verdict.AGREE),
        (0.8, 0.8 + 1.1 * EDGE_TOLERANCE, Verdict.DISAGREE),
        (None, None, Verdict.AGREE),
        (None, 0.8, Verdict.DISAGREE),
        (0.8, None, Verdict.DISAGREE),
        (math.nan, 0.8, Verdict.INCONCLUSIVE),
    ],
)
def test_edges_are_compared_with_the_converged_reference(edge, converged, verdict) -> None:
    assert compare_edge(edge, converged).verdict is verdict


def values(first, second, steps=(1.0, 0.5, 0.25)):
    """A scheme whose error has parts of the first and of the second order."""
    return [-3.0 + first * step + second * step**2 for step in steps]


@pytest.mark.parametrize(("first", "second"), [(0.1, 0.0), (0.0, 0.1), (0.1, -0.1), (0.1, -0.2), (-0.1, 0.3)])
def test_bar_of_three_steps_covers_the_error_of_the_middle_one(first, second) -> None:
    """For (0.1, −0.2) the two middle values are both off by nothing or by little."""
    _, middle, _ = found = values(first, second)
    assert scheme_bar(*found) >= abs(middle + 3.0)


def test_estimate_from_two_steps_covers_a_first_order_error() -> None:
    coarse, fine, _ = values(0.1, 0.0)
    assert abs(fine + 3.0) < step_estimate(coarse, fine) < 1.3 * abs(fine + 3.0)


def test_verdict_names_the_largest_part_of_what_is_allowed() -> None:
    tolerance = Tolerance(reference=0.1, engine=0.2, resolution=0.05, scheme=0.15)
    assert tolerance.allowed == pytest.approx(0.35)
    assert compare(1.34, 1.0, tolerance, "dB").verdict is Verdict.AGREE
    found = compare(0.64, 1.0, tolerance, "dB")
    assert found.verdict is Verdict.DISAGREE
    assert found.reason == "difference -0.36 dB, allowed 0.35, mostly the engine's own step (0.2)"
    lucky = Tolerance(reference=0.1, engine=0.0, resolution=0.05, scheme=0.15)
    assert "mostly the error of the reference's scheme at this step (0.15)" in str(lucky)


def test_nothing_to_compare_is_inconclusive() -> None:
    assert compare(math.nan, 1.0, Tolerance(0.1, 0.1)).verdict is Verdict.INCONCLUSIVE
    assert compare(1.0, 1.0, Tolerance(math.nan, 0.1)).verdict is Verdict.INCONCLUSIVE
