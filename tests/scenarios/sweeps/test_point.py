"""Points of figure 3: what is allowed of those that share the scheme, and of those that do not."""

import dataclasses
import math

import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.sweeps.point import UNBOUNDED, Point, point_findings
from multibody_xval.scenarios.sweeps.sweep import Case, GivenTolerance, baseline, refinements
from multibody_xval.scenarios.verdicts.finding import FLOOR_DB, PHASE, TRANSMITTANCE, Comparison, Finding, Verdict
from multibody_xval.scenarios.verdicts.steady_case import AMPLIFICATION_MARGIN, CONVERGED, REFERENCE

SHARES, OWN = Variant("mujoco"), Variant("exudyn-regularised")


PHASE_LAG = -2.0
"""Of the reference [rad]."""


def answer(db, steps=400, status="converged", late=0.0) -> Result:
    """Give a result that is late by `late` [rad]; without a steady state, it is far from repeating."""
    residual = 1e-9 if status == "converged" else 1e-3
    return Result(
        status=status,
        transmittance_db=db,
        phase=PHASE_LAG - late,
        residual=residual,
        periods=30,
        steps_per_period=steps,
    )


def judged(
    variant, db, *others, reference=-10.02, converged=-10.0, amplified=1.0, given=None, late=0.0, effect=UNBOUNDED,
    status="converged",
):  # fmt: skip
    known = Point(
        variant=variant,
        case=Case.of(friction_ratio=0.3),
        frequency_ratio=0.9,
        result=answer(db, late=late, status=status),
        others=others,
        reference=dataclasses.replace(answer(reference), amplification=amplified / AMPLIFICATION_MARGIN),
        converged=answer(converged),
        given=given,
        effect=effect,
    )
    return dataclasses.replace(known, findings=point_findings(known)).comparison


def test_who_shares_the_scheme_equals_the_reference_at_equal_step_or_does_not_share_it() -> None:
    assert baseline(SHARES) == REFERENCE
    assert judged(SHARES, -10.02 + 1e-8).verdict is Verdict.AGREE
    comparison = judged(SHARES, -10.02 + 1e-6)
    assert comparison.verdict is Verdict.DISAGREE
    assert "mostly resolution" in comparison.reason


def test_near_a_resonance_a_steady_state_is_farther_than_its_residual() -> None:
    assert judged(SHARES, -10.02 + 1e-6, amplified=100.0).verdict is Verdict.AGREE
    assert judged(SHARES, -10.02 + 1e-4, amplified=100.0).verdict is Verdict.DISAGREE


def test_an_integrator_of_its_own_may_err_as_the_scheme_does_at_the_same_step() -> None:
    assert baseline(OWN) == CONVERGED
    assert judged(OWN, -9.98, answer(-9.98, 200)).verdict is Verdict.AGREE
    comparison = judged(OWN, -9.97, answer(-9.97, 200))
    assert comparison.verdict is Verdict.DISAGREE
    assert "the error of the reference's scheme at this step (0.026)" in comparison.reason


def test_an_error_that_halves_with_the_step_is_its_own() -> None:
    comparison = judged(OWN, -9.5, answer(-9.0, 200))
    assert comparison.verdict is Verdict.AGREE
    assert "mostly the engine's own step (0.62" in comparison.reason
    # where stability asks for 300 steps instead of half of 400, the same difference tells of three times the error
    assert judged(OWN, -9.0, answer(-8.7, 300)).verdict is Verdict.AGREE
    assert judged(OWN, -9.0, answer(-8.7, 200)).verdict is Verdict.DISAGREE


def test_without_a_steady_state_at_half_the_steps_a_difference_is_inconclusive() -> None:
    lost = answer(-9.0, 200, "period limit")
    assert judged(OWN, -9.5, lost).verdict is Verdict.INCONCLUSIVE
    assert judged(OWN, -9.99, lost).verdict is Verdict.AGREE


def test_the_references_error_cannot_excuse_itself() -> None:
    assert refinements(REFERENCE) == (2, 4)
    assert judged(REFERENCE, -10.02, answer(-10.01, 800), answer(-10.005, 1600)).verdict is Verdict.AGREE
    assert judged(REFERENCE, -10.02, answer(-10.02, 800), answer(-10.02, 1600)).verdict is Verdict.DISAGREE


def test_a_difference_that_vanishes_by_chance_is_not_believed() -> None:
    """Errors of 400 and 800 steps on either side of the truth: the third step tells."""
    assert judged(REFERENCE, -10.02, answer(-10.02, 800), answer(-10.01, 1600)).verdict is Verdict.AGREE


def test_ruler_and_sharers_need_no_second_step() -> None:
    assert refinements(CONVERGED) == refinements(SHARES) == ()
    assert refinements(OWN) == (0.5,)
    assert judged(CONVERGED, -10.0).verdict is Verdict.AGREE


def test_below_the_floor_differences_are_those_of_amplitudes() -> None:
    deep = FLOOR_DB - 40
    comparison = judged(OWN, deep + 6, answer(deep + 6, 200), reference=deep, converged=deep)
    assert comparison.difference == pytest.approx(8.7 * 1e-2 * (10 ** (6 / 20) - 1), rel=0.02)


@pytest.mark.parametrize(("whom", "level"), [(REFERENCE, -10.02), (CONVERGED, -10.0)])
def test_a_given_tolerance_judges_everybody_but_whom_others_are_compared_with(whom, level) -> None:
    given = GivenTolerance(transmittance_db=0.1, baseline=whom)
    for variant in (SHARES, OWN):
        assert baseline(variant, given) == whom
        assert refinements(variant, given) == ()
        assert judged(variant, level + 0.099, given=given).verdict is Verdict.AGREE
        comparison = judged(variant, level - 0.101, given=given)
        assert comparison.verdict is Verdict.DISAGREE
        assert comparison.tolerance == pytest.approx(0.1, rel=1e-12)
    # its own steps are its measure still
    assert refinements(whom, given) == refinements(whom)
    assert judged(REFERENCE, -10.02, answer(-10.02, 800), given=GivenTolerance(transmittance_db=9, baseline=REFERENCE)
                  ).verdict is Verdict.DISAGREE  # fmt: skip


def test_a_motion_of_the_right_size_that_is_late_by_a_step_disagrees_at_equal_step() -> None:
    comparison = judged(SHARES, -10.02, late=2 * math.pi / 400)
    assert comparison.verdict is Verdict.DISAGREE
    assert comparison.reason.startswith("phase: difference -0.9 °, allowed")
    assert judged(SHARES, -10.02).verdict is Verdict.AGREE


def test_the_worse_of_level_and_phase_decides() -> None:
    slightly_late = 1e-5
    assert judged(SHARES, -10.02 + 1.0, late=slightly_late).reason.startswith("difference +1 dB")
    assert judged(SHARES, -10.02 + 1e-8, late=slightly_late).reason.startswith("phase: ")


def test_a_scheme_of_its_own_may_be_late_by_what_its_steps_show() -> None:
    late = 2 * math.pi / 400
    assert judged(OWN, -10.0, answer(-10.0, 200, late=2 * late), late=late).verdict is Verdict.AGREE
    assert judged(OWN, -10.0, answer(-10.0, 200, late=late), late=late).verdict is Verdict.DISAGREE


def test_a_given_tolerance_is_one_of_the_phase_too() -> None:
    given = GivenTolerance(transmittance_db=0.1, baseline=REFERENCE)
    largest = 10 ** (0.1 / 20) - 1
    assert judged(OWN, -10.02, given=given, late=0.99 * largest).verdict is Verdict.AGREE
    assert judged(OWN, -10.02, given=given, late=1.01 * largest).verdict is Verdict.DISAGREE


def test_a_step_that_leaves_open_what_friction_changes_shows_nothing() -> None:
    coarse = answer(-9.0, 200)
    small, large = ({TRANSMITTANCE: effect, PHASE: math.inf} for effect in (1.0, 20.0))
    assert judged(OWN, -9.5, coarse, effect=small).verdict is Verdict.TOO_COARSE
    assert judged(OWN, -9.5, coarse, effect=large).verdict is Verdict.AGREE


def test_a_motion_that_is_not_certified_but_repeats_well_enough_is_compared_and_said_to_be_uncertified() -> None:
    known = Point(
        variant=OWN,
        case=Case.of(friction_ratio=0.3),
        frequency_ratio=0.9,
        result=dataclasses.replace(answer(-10.0, status="period limit"), residual=2e-8),
        others=(answer(-10.0, 200),),
        reference=dataclasses.replace(answer(-10.02), amplification=0.5),
        converged=answer(-10.0),
    )
    assert {(own.comparison.verdict, own.comparison.certified) for own in point_findings(known)} == {
        (Verdict.AGREE, False)
    }
    far = dataclasses.replace(known, result=answer(-10.0, status="period limit"))
    assert dataclasses.replace(far, findings=point_findings(far)).comparison.verdict is Verdict.INCONCLUSIVE


def test_what_is_allowed_of_a_metric_is_not_that_of_another() -> None:
    answers = {PHASE: (1.0, 2.0), TRANSMITTANCE: (0.1, 0.2)}
    findings = tuple(
        Finding(OWN, "", metric, 0.0, 0.0, Comparison(Verdict.AGREE, "", difference=off, tolerance=allowed))
        for metric, (off, allowed) in answers.items()
    )
    case = Case.of(friction_ratio=0.3)
    known = Point(variant=OWN, case=case, frequency_ratio=0.9, result=answer(-10.0), reference=answer(-10.0),
                  converged=answer(-10.0), findings=findings)  # fmt: skip
    for metric in (PHASE, TRANSMITTANCE):
        assert (known.difference(metric), known.allowed(metric)) == answers[metric]
