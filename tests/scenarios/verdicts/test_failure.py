"""What fails a run: disagreements without a law, and presets of which too little is certified."""

import dataclasses

import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.registry import CATALOGUE
from multibody_xval.scenarios.runs.result import RESOLVED_DB, Result
from multibody_xval.scenarios.verdicts.finding import (
    TRANSMITTANCE,
    Comparison,
    Finding,
    Prediction,
    Verdict,
    engine_failures,
    failures,
    silent,
    unmodelled,
)
from multibody_xval.scenarios.verdicts.judge import missing
from multibody_xval.scenarios.verdicts.prediction import LawPeriod, with_predictions
from multibody_xval.scenarios.verdicts.steady_case import is_resolved
from tests.scenarios.conftest import WRONG, InProcess

OWN_SCHEME = Variant("drake")


def finding(verdict: Verdict, certified: bool = True, prediction: Prediction | None = None, variant=OWN_SCHEME):
    comparison = Comparison(verdict, "by hand", certified=certified)
    return Finding(variant, "case", TRANSMITTANCE, -10.0, -20.0, comparison, prediction)


def prediction(left: float = 0.0, certified: bool = True) -> Prediction:
    return Prediction(
        value=-10.0, difference=left, allowed=1e-3, distance=0.0, period_bound=1e-9, certified=certified
    )  # fmt: skip


def blocked(reason: str) -> Finding:
    comparison = missing("", [Result.blocked(reason)])
    assert comparison is not None
    return dataclasses.replace(finding(Verdict.AGREE), comparison=comparison)


AGREES = [finding(Verdict.AGREE)] * 3


@pytest.mark.parametrize(
    ("last", "fails"),
    [
        ([finding(Verdict.AGREE)], False),
        ([finding(Verdict.DISAGREE)], True),
        ([finding(Verdict.DISAGREE, prediction=prediction())], False),
        ([finding(Verdict.DISAGREE, prediction=prediction(left=28.0))], True),
        ([finding(Verdict.TOO_COARSE)], False),  # one in four
        ([finding(Verdict.TOO_COARSE)] * 2, True),
        ([finding(Verdict.TOO_COARSE, variant=Variant("mujoco"))] * 5, False),  # the scheme's step is as coarse
        ([finding(Verdict.TOO_COARSE, prediction=prediction())] * 2, False),
        ([finding(Verdict.TOO_COARSE, prediction=prediction(left=1.0))], True),
        ([finding(Verdict.INCONCLUSIVE, certified=False)], False),
        ([finding(Verdict.INCONCLUSIVE, certified=False)] * 2, True),
        ([finding(Verdict.AGREE, certified=False)] * 2, True),  # resolved, but not to what the engine claims
        ([finding(Verdict.INCONCLUSIVE, certified=False, prediction=prediction(certified=False))] * 2, False),
        ([finding(Verdict.INCONCLUSIVE, certified=False, prediction=prediction(certified=True))] * 2, True),
        ([finding(Verdict.INCONCLUSIVE)] * 9, False),  # skipped, or not run
        ([blocked("the worker process crashed: Segmentation fault")], False),
        ([blocked("the worker process crashed: Segmentation fault")] * 2, True),
        ([blocked("not installed: no wheel")] * 9, False),
        ([blocked("cannot be represented: too heavy")] * 9, False),
        ([blocked("cannot be represented: too heavy")] * 9 + [blocked("not finite")] * 2, True),
    ],
)
def test_what_fails_beside_three_numbers_that_agree(last, fails) -> None:
    own = [dataclasses.replace(agreeing, variant=last[0].variant) for agreeing in AGREES]
    assert bool(failures([*own, *last])) is fails


def test_a_failure_names_the_preset_and_the_share() -> None:
    (line,) = failures([finding(Verdict.INCONCLUSIVE, certified=False)] * 2)
    assert line.startswith("drake: 2 of 2 numbers without a certified steady state")
    assert line.endswith("allowed: 25%")
    (line,) = failures([*AGREES, finding(Verdict.DISAGREE)])
    assert line == "unmodelled: 1 disagreement, of drake"


def test_every_number_that_an_engine_fails_to_give_is_named() -> None:
    (line,) = engine_failures([*AGREES, blocked("no solution"), blocked("not installed: no wheel")])
    assert line == "drake fails at 1 number of case: no solution"


def test_a_law_without_a_steady_state_predicts_one_that_is_not_certified() -> None:
    law = OWN_SCHEME.law
    assert law is not None
    gap = Comparison(Verdict.INCONCLUSIVE, "no steady state", certified=False)
    (own,), (of_law,) = (
        Finding.without_numbers(variant, "case", [TRANSMITTANCE], gap) for variant in (OWN_SCHEME, law)
    )
    period = {"case": LawPeriod(0.0, 1.0)}
    (judged,) = with_predictions([own], [of_law], period)
    assert silent([judged]) == unmodelled([judged]) == []
    (judged,) = with_predictions([own], [finding(Verdict.AGREE, variant=law)], period)
    assert silent([judged]) == [judged]


class Noisy(InProcess):
    """Answers by the reference; the motions of `WRONG` do not repeat better than to a residual."""

    def __init__(self, residual: float):
        super().__init__(lambda task: task)
        self.residual = residual

    def evaluate(self, tasks):
        return [
            dataclasses.replace(result, status="period limit", residual=self.residual, multiple=0)
            if task.variant == WRONG
            else result
            for task, result in zip(tasks, super().evaluate(tasks), strict=True)
        ]


@pytest.mark.parametrize(
    ("residual", "verdicts"), [(2.9e-8, {Verdict.AGREE}), (1e-3, {Verdict.INCONCLUSIVE})], ids=["resolved", "noise"]
)
def test_a_motion_that_is_not_certified_is_compared_where_its_own_residual_resolves_it(residual, verdicts) -> None:
    """Either way a preset that is never certified fails: it does not repeat as well as it claims."""
    findings = CATALOGUE["frictionless-limit"].run([WRONG], Noisy(residual))
    assert {finding.comparison.verdict for finding in findings} == verdicts
    assert not any(finding.comparison.certified for finding in findings)
    assert failures(findings)


def test_what_resolves_a_motion_is_its_residual_amplified_beside_its_size() -> None:
    noisy = Result(status="period limit", transmittance_db=-40.0, residual=1e-8)
    assert is_resolved(noisy, 1.0)
    assert not is_resolved(noisy, 1e3)
    assert not is_resolved(dataclasses.replace(noisy, transmittance_db=-100.0), 1.0)
    assert not is_resolved(dataclasses.replace(noisy, status="diverged"), 1.0)
    assert RESOLVED_DB == 1e-3
