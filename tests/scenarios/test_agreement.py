"""Verdicts: agree, disagree, inconclusive, blocked."""

import math

import pytest

from scenarios.agreement import (
    EDGE_TOLERANCE,
    Verdict,
    allowed_difference_db,
    compare_edge,
    compare_transmittance,
)
from scenarios.questions import Answer


def answer(db, status="converged", **more) -> Answer:
    return Answer(status=status, transmittance_db=db, residual=1e-9, periods=30, **more)


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
    comparison = compare_transmittance(Answer.blocked("not installed:\n no wheel"), answer(-10.0), 0.02)
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
