"""One ruler: every variant is compared with the same truth, whose error is known."""

import math
from dataclasses import replace

import pandas as pd
import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.steady import run_steady_states
from multibody_xval.scenarios.runs.task import SteadyStateTask
from multibody_xval.scenarios.sweeps.point import Point
from multibody_xval.scenarios.sweeps.sweep import Case
from multibody_xval.scenarios.sweeps.truths import WRONG_DB, ErrorClass, error_class, truth_error, truth_of
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED, EXACT, REFERENCE

ENGINE = Variant("exudyn-bristle")
"""Has an integrator of its own, and so a verdict against the converged reference."""

TRUE_DB = -20.0
CASE = Case.of(friction_ratio=0.3)


def result(level: float, steps: int = 400, residual: float = 1e-9) -> Result:
    return Result(
        status="converged", transmittance_db=level, phase=0.0, residual=residual, amplification=1.0, periods=30,
        steps_per_period=steps, period=1.0,
    )  # fmt: skip


def known(variant: Variant, level: float) -> Point:
    """A scheme that errs by 0.08 dB with 400 steps, in proportion to the step."""
    return Point(
        variant=variant,
        case=CASE,
        frequency_ratio=0.9,
        result=result(level),
        reference=result(TRUE_DB + 0.08),
        converged=result(TRUE_DB + 0.08 / 32),
        refined=(result(TRUE_DB + 0.04, 800), result(TRUE_DB + 0.02, 1600)),
    )


EXACT_RESULT = result(TRUE_DB, residual=1e-12)


@pytest.mark.parametrize("variant", [ENGINE, Variant("mujoco"), REFERENCE])
def test_one_number_has_one_error_whatever_its_variant_is_judged_by(variant: Variant) -> None:
    own = known(variant, TRUE_DB + 0.5)
    error_db, step_db = truth_error(replace(own, truth=truth_of(own, EXACT_RESULT)))
    assert error_db == pytest.approx(0.5, abs=1e-12)
    assert step_db == pytest.approx(1.25 * 0.08, rel=1e-3)


def test_the_truth_is_the_exact_motion_where_it_is_certified_and_the_converged_reference_elsewhere() -> None:
    own = known(ENGINE, TRUE_DB)
    exact = truth_of(own, EXACT_RESULT)
    assert (exact.transmittance_db, exact.exact) == (TRUE_DB, True)
    assert 0 < exact.error_db < 1e-8
    for lost in (Result.missing(), replace(EXACT_RESULT, status="period limit")):
        other = truth_of(own, lost)
        assert (other.transmittance_db, other.exact) == (TRUE_DB + 0.08 / 32, False)
        assert 0.08 / 32 < other.error_db < 0.08
    nothing = replace(own, converged=Result.missing())
    assert math.isnan(truth_of(nothing, Result.missing()).transmittance_db)


def test_without_a_steady_state_there_is_no_error() -> None:
    own = known(ENGINE, TRUE_DB)
    truth = truth_of(own, EXACT_RESULT)
    assert math.isnan(truth_error(replace(own, result=Result.blocked("not installed"), truth=truth))[0])


@pytest.mark.parametrize(
    ("errors", "expected"),
    [
        ([], None),
        ([0.05, -0.09], ErrorClass.WITHIN_STEP),
        ([0.05, -0.11], ErrorClass.VISIBLE),
        ([0.05, WRONG_DB - 0.01], ErrorClass.VISIBLE),
        ([0.05, -WRONG_DB], ErrorClass.WRONG),
    ],
)
def test_a_variant_is_as_good_as_its_worst_point(errors: list[float], expected: ErrorClass | None) -> None:
    assert error_class(pd.DataFrame({"error_db": errors, "step_db": 0.1}, dtype=float)) is expected


def test_the_scheme_is_within_its_own_step_and_the_converged_reference_nearer_to_the_truth() -> None:
    """In the real chain, where the exact motion is certified far below any error of a step."""
    tasks = {
        v: SteadyStateTask(variant=v, friction_ratio=0.3, frequency_ratio=0.9) for v in (REFERENCE, CONVERGED, EXACT)
    }
    results = {variant: run_steady_states([task])[0] for variant, task in tasks.items()}
    own = Point(
        variant=REFERENCE, case=CASE, frequency_ratio=0.9, result=results[REFERENCE], reference=results[REFERENCE],
        converged=results[CONVERGED],
    )  # fmt: skip
    own = replace(own, truth=truth_of(own, results[EXACT]))
    assert own.truth.exact
    assert own.truth.error_db < 1e-8
    scheme, step = truth_error(own)
    converged, _ = truth_error(replace(own, variant=CONVERGED, result=results[CONVERGED]))
    assert abs(scheme) <= step
    assert abs(converged) < abs(scheme) / 10
