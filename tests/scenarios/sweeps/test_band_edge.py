"""Band edges: what is allowed of them follows from the transmittance beside them and the slope of the curve."""

import dataclasses
import math

import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.sweeps.attenuation_band import Crossing
from multibody_xval.scenarios.sweeps.edges import compare_edge
from multibody_xval.scenarios.sweeps.point import Point, tolerance
from multibody_xval.scenarios.sweeps.sweep import Case, GivenTolerance
from multibody_xval.scenarios.verdicts.finding import TRANSMITTANCE, Verdict
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED

SLOPE, WIDTH = -100.0, 1e-5
PLACE = 0.8
TRUE = Crossing(PLACE, SLOPE, WIDTH)


def result(db, steps, status="converged") -> Result:
    residual = 1e-9 if status == "converged" else 1e-3
    return Result(
        status=status, transmittance_db=db, residual=residual, periods=30, steps_per_period=steps, amplification=0.5
    )


def point(level, own, **changes) -> Point:
    """A point whose own error halves with the step, `own` dB at the judged one; the reference's is 0.01 dB."""
    known = Point(
        variant=Variant("exudyn-regularised"),
        case=Case.of(friction_ratio=0.3),
        frequency_ratio=PLACE,
        result=result(level + own, 400),
        others=(result(level + 2 * own, 200),),
        reference=result(level + 0.01, 400),
        converged=result(level + 0.01 / 32, 400),
        refined=(result(level + 0.005, 800), result(level + 0.0025, 1600)),
    )
    return dataclasses.replace(known, **changes)


@pytest.mark.parametrize(("share", "verdict"), [(0.99, Verdict.AGREE), (1.01, Verdict.DISAGREE)])
def test_an_edge_may_be_off_by_the_error_of_the_curve_over_its_slope(share, verdict) -> None:
    around = [point(3.0, 0.1), point(-3.0, 0.05)]
    allowed = tolerance(around[0]).allowed / abs(SLOPE) + 2 * WIDTH
    assert allowed == pytest.approx(1.25 * (0.1 + 2 * 0.01 / 32) / 100 + 2 * WIDTH, rel=1e-3)
    comparison = compare_edge(Crossing(PLACE + share * allowed, SLOPE, WIDTH), TRUE, around)
    assert comparison.verdict is verdict
    assert comparison.tolerance == pytest.approx(allowed, rel=1e-3)
    assert "mostly the engine's own step" in comparison.reason


def test_an_engine_without_an_error_of_its_own_may_be_off_as_the_scheme_is() -> None:
    around = [point(3.0, 0.0), point(-3.0, 0.0)]
    off = 1.25 * 0.01 / 100
    assert compare_edge(Crossing(PLACE + 0.9 * off, SLOPE, WIDTH), TRUE, around).verdict is Verdict.AGREE
    assert compare_edge(Crossing(PLACE + 1.5 * off, SLOPE, WIDTH), TRUE, around).verdict is Verdict.DISAGREE


def test_a_tolerance_that_is_given_is_one_of_the_curve() -> None:
    given = GivenTolerance(transmittance_db=0.5, baseline=CONVERGED)
    around = [point(3.0, 0.0, given=given)]
    assert compare_edge(Crossing(PLACE + 0.0049, SLOPE), TRUE, around).verdict is Verdict.AGREE
    assert compare_edge(Crossing(PLACE + 0.0051, SLOPE), TRUE, around).verdict is Verdict.DISAGREE


def test_a_motion_that_is_not_certified_leaves_its_residual_open() -> None:
    around = [point(3.0, 0.0)]
    far = Crossing(PLACE + 0.002, SLOPE, WIDTH)
    assert compare_edge(far, TRUE, around).verdict is Verdict.DISAGREE
    assert compare_edge(dataclasses.replace(far, residual_db=0.2), TRUE, around).verdict is Verdict.AGREE


def test_without_a_steady_state_beside_it_a_difference_is_inconclusive() -> None:
    lost = point(3.0, 0.0, result=result(3.0, 400, "period limit"))
    coarse_lost = point(3.0, 0.0, others=(result(3.0, 200, "period limit"),))
    for around in ([lost], [], [coarse_lost]):
        assert compare_edge(Crossing(PLACE + 0.1, SLOPE, WIDTH), TRUE, around).verdict is Verdict.INCONCLUSIVE
        assert compare_edge(TRUE, TRUE, around).verdict is Verdict.AGREE


@pytest.mark.parametrize(
    ("edge", "converged", "verdict"),
    [
        (None, None, Verdict.AGREE),
        (None, TRUE, Verdict.DISAGREE),
        (TRUE, None, Verdict.DISAGREE),
        (Crossing(math.nan), TRUE, Verdict.INCONCLUSIVE),
    ],
)
def test_edges_that_are_not_there(edge, converged, verdict) -> None:
    assert compare_edge(edge, converged).verdict is verdict


@pytest.mark.parametrize(("own", "verdict"), [(0.3, Verdict.AGREE), (0.34, Verdict.TOO_COARSE)])
def test_an_edge_beside_which_the_step_is_too_coarse_shows_nothing(own, verdict) -> None:
    """A tenth of the 4 dB that friction changes on one side of it at all is 1.25 × 0.32 dB."""
    around = [point(3.0, own, effect={TRANSMITTANCE: 4.0}), point(-3.0, own, effect={TRANSMITTANCE: 9.0})]
    assert compare_edge(TRUE, TRUE, around).verdict is verdict
    assert compare_edge(Crossing(PLACE + 0.05, SLOPE, WIDTH), TRUE, around).verdict is Verdict.DISAGREE
