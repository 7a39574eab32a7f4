"""Stick and slip compared: what is late, missed, made up, inconclusive; by transitions made by hand."""

import dataclasses
import math

import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.verdicts.finding import Verdict
from multibody_xval.scenarios.verdicts.steady_case import Evidence, Expected, SteadyCase
from multibody_xval.scenarios.verdicts.stick_slip_comparison import (
    CREEP_VELOCITY,
    LARGEST_TIME,
    MEDIAN_TIME,
    MISSED,
    SPURIOUS,
    STICK_SLIP_METRICS,
    STUCK_FRACTION,
    as_resolved,
    stick_slip_findings,
)
from reference_lcp.observables.stick_slip import MATCHING_WINDOW

TRANSITIONS = ((1, 0.1, "stick"), (1, 0.3, "forward slip"), (1, 0.6, "stick"), (1, 0.8, "backward slip"))
SHORT = ((1, 0.45, "stick"), (1, 0.455, "forward slip"))
CASE = SteadyCase(label="by hand", friction_ratio=0.3, frequency_ratio=0.9)
STEP = 1 / 800


def answer(transitions, steps, stuck=0.4, creep=0.0) -> Result:
    return Result(
        status="converged", transmittance_db=-3.0, residual=1e-9, amplification=1.0, periods=30,
        steps_per_period=steps, period=1.0,
        stuck_fraction=(stuck,), transitions=tuple(transitions), creep=(creep,),
    )  # fmt: skip


def evidence(coarse, fine, scheme=None, expected=TRANSITIONS, variant="mujoco", **changes) -> Evidence:
    """Transitions of the engine at both steps, and of the reference at three; further numbers are of the fine one."""
    scheme = scheme or (TRANSITIONS,) * 3
    return Evidence(
        variant=Variant(variant),
        case=CASE,
        coarse=answer(coarse, 400),
        fine=dataclasses.replace(answer(fine, 800), **changes),
        scheme=tuple(answer(transitions, steps) for transitions, steps in zip(scheme, (400, 800, 1600), strict=True)),
        expected=Expected(transmittance_db=-3.0, transitions=expected, stuck_fraction=(0.4,)),
    )


def judged(*args, **more):
    return {finding.metric: finding for finding in stick_slip_findings(evidence(*args, **more))}


def later(shift, transitions=TRANSITIONS):
    return tuple((cell, (time + shift) % 1.0, kind) for cell, time, kind in transitions)


def test_the_expected_motion_agrees_in_every_metric() -> None:
    findings = judged(TRANSITIONS, TRANSITIONS)
    assert tuple(findings) == STICK_SLIP_METRICS
    assert {finding.comparison.verdict for finding in findings.values()} == {Verdict.AGREE}


@pytest.mark.parametrize(("steps", "verdict"), [(0.9, Verdict.AGREE), (-0.9, Verdict.AGREE), (1.1, Verdict.DISAGREE)])
def test_a_transition_may_be_a_step_off_whatever_the_sign(steps, verdict) -> None:
    findings = judged(later(steps * STEP), later(steps * STEP))
    assert findings[LARGEST_TIME].comparison.verdict is verdict
    assert findings[MEDIAN_TIME].value == pytest.approx(100 * abs(steps) * STEP)


def test_an_error_that_halves_with_the_step_is_the_engines_own() -> None:
    findings = judged(later(8 * STEP), later(4 * STEP))
    assert findings[LARGEST_TIME].comparison.verdict is Verdict.AGREE
    assert "mostly the engine's own step" in findings[LARGEST_TIME].comparison.reason
    assert judged(later(4 * STEP), later(4 * STEP))[LARGEST_TIME].comparison.verdict is Verdict.DISAGREE


def test_an_error_that_the_reference_makes_at_the_same_step_is_no_disagreement() -> None:
    """At some step an engine may happen to err as much as at the other: its own estimate is then zero by luck."""
    scheme = (later(8 * STEP), later(4 * STEP), later(2 * STEP))
    findings = judged(later(4 * STEP), later(4 * STEP), scheme=scheme)
    assert findings[LARGEST_TIME].comparison.verdict is Verdict.AGREE
    assert "error of the reference's scheme" in findings[LARGEST_TIME].comparison.reason


def test_the_worst_transition_is_the_one_that_is_worst_beside_what_is_allowed_for_it() -> None:
    fine = (*TRANSITIONS[:3], (1, 0.8 + 3 * STEP, "backward slip"))
    findings = judged(fine, fine)
    assert findings[LARGEST_TIME].value == pytest.approx(300 * STEP)
    assert findings[MEDIAN_TIME].value == pytest.approx(0, abs=1e-12)


def test_transitions_beyond_the_window_are_missed_and_spurious() -> None:
    gone = later(1.01 * MATCHING_WINDOW)
    findings = judged(gone, gone)
    assert findings[MISSED].value == findings[SPURIOUS].value == 4
    assert findings[MISSED].comparison.verdict is findings[SPURIOUS].comparison.verdict is Verdict.DISAGREE
    assert findings[LARGEST_TIME].comparison.verdict is Verdict.INCONCLUSIVE


def test_what_only_one_step_of_the_engine_misses_or_makes_up_is_inconclusive() -> None:
    fewer, more = TRANSITIONS[2:], (*TRANSITIONS, *SHORT)
    assert judged(TRANSITIONS, fewer)[MISSED].comparison.verdict is Verdict.INCONCLUSIVE
    assert judged(fewer, fewer)[MISSED].comparison.verdict is Verdict.DISAGREE
    assert judged(TRANSITIONS, more)[SPURIOUS].comparison.verdict is Verdict.INCONCLUSIVE
    assert judged(more, more)[SPURIOUS].comparison.verdict is Verdict.DISAGREE


def test_a_grazing_stick_that_the_reference_has_at_some_steps_only_is_left_out() -> None:
    with_it = (*TRANSITIONS, *SHORT)
    step_dependent = (TRANSITIONS, with_it, with_it)
    for expected, own in ((with_it, TRANSITIONS), (TRANSITIONS, with_it)):
        verdicts = judged(own, own, scheme=step_dependent, expected=expected)
        for metric in (MISSED, SPURIOUS, LARGEST_TIME):
            assert verdicts[metric].comparison.verdict is Verdict.AGREE, metric
        reasons = verdicts[MISSED].comparison.reason + verdicts[SPURIOUS].comparison.reason
        assert "2 grazing ones left out" in reasons
    decided = judged(TRANSITIONS, TRANSITIONS, scheme=(with_it,) * 3, expected=with_it)
    assert decided[MISSED].comparison.verdict is Verdict.DISAGREE


def test_stuck_fraction_may_be_off_by_a_step_a_stick() -> None:
    for steps, verdict in ((1.9, Verdict.AGREE), (2.1, Verdict.DISAGREE)):
        given = evidence(TRANSITIONS, TRANSITIONS, stuck_fraction=(0.4 + steps * STEP,))
        same = dataclasses.replace(given.coarse, stuck_fraction=given.fine.stuck_fraction)
        judgement = {
            finding.metric: finding for finding in stick_slip_findings(dataclasses.replace(given, coarse=same))
        }
        assert judgement[STUCK_FRACTION].comparison.verdict is verdict


@pytest.mark.parametrize(
    ("variant", "creep", "verdict"),
    [
        ("mujoco", 1e-6, Verdict.AGREE),
        ("mujoco", 1e-4, Verdict.DISAGREE),
        ("box2d", 1e-4, Verdict.AGREE),
        ("box2d", 1e-2, Verdict.DISAGREE),
    ],
)
def test_a_stick_may_creep_by_no_more_than_the_orbit_resolves(variant, creep, verdict) -> None:
    given = evidence(TRANSITIONS, TRANSITIONS, variant=variant, creep=(creep,))
    same = dataclasses.replace(given, coarse=dataclasses.replace(given.coarse, creep=(creep,)))
    judgement = {finding.metric: finding for finding in stick_slip_findings(same)}
    assert judgement[CREEP_VELOCITY].comparison.verdict is verdict


def test_without_a_steady_state_every_metric_is_inconclusive() -> None:
    given = evidence(TRANSITIONS, TRANSITIONS, status="period limit", residual=1e-3)
    findings = stick_slip_findings(given)
    assert [finding.metric for finding in findings] == list(STICK_SLIP_METRICS)
    assert {finding.comparison.verdict for finding in findings} == {Verdict.INCONCLUSIVE}


def test_a_slip_too_short_for_single_precision_is_read_as_stick() -> None:
    """The contact turns, slips by 5e-6 U0 and stops: with a residual of 1e-5, it stops where it turns."""
    exact = ((1, 0.1, "forward slip"), (1, 0.106, "stick"), (1, 0.3, "backward slip"))
    read = ((1, 0.1, "stick"), (1, 0.3, "backward slip"))
    for variant, expected in (("mujoco", exact), ("box2d", read)):
        given = evidence(expected, expected, scheme=(exact,) * 3, expected=exact, variant=variant)
        stuck = 0.194 if variant == "mujoco" else 0.2
        answers = {
            name: dataclasses.replace(getattr(given, name), stuck_fraction=(stuck,)) for name in ("coarse", "fine")
        }
        scheme = tuple(dataclasses.replace(result, stuck_fraction=(0.194,)) for result in given.scheme)
        right = dataclasses.replace(given.expected, travels=(5e-6, math.inf, 2.0), stuck_fraction=(0.194,))
        given = dataclasses.replace(given, expected=right, scheme=scheme, **answers)
        assert as_resolved(given).transitions == expected
        assert as_resolved(given).stuck_fraction[0] == pytest.approx(stuck)
        assert {finding.comparison.verdict for finding in stick_slip_findings(given)} == {Verdict.AGREE}


def test_a_time_that_steps_leave_open_by_more_than_a_tenth_of_a_quarter_period_shows_nothing() -> None:
    late = 0.95 * MATCHING_WINDOW
    for metric in (MEDIAN_TIME, LARGEST_TIME):
        assert judged(later(late), later(-late))[metric].comparison.verdict is Verdict.TOO_COARSE
        assert judged(later(late), later(late / 2))[metric].comparison.verdict is Verdict.AGREE


@pytest.mark.parametrize(("creep", "verdict"), [(0.05, Verdict.AGREE), (0.2, Verdict.TOO_COARSE)])
def test_a_creep_that_halves_with_the_step_shows_nothing_where_it_is_large(creep, verdict) -> None:
    own = evidence(TRANSITIONS, TRANSITIONS, creep=(creep,))
    coarse = dataclasses.replace(own, coarse=dataclasses.replace(own.coarse, creep=(2 * creep,)))
    findings = {finding.metric: finding for finding in stick_slip_findings(coarse)}
    assert findings[CREEP_VELOCITY].comparison.verdict is verdict
