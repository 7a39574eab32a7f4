"""Motions that are not there: those that failed are blocked, those that nobody has asked for are inconclusive."""

from scenarios.runs.result import Result
from scenarios.verdicts.finding import Verdict
from scenarios.verdicts.judge import missing

FINISHED = Result(status="finished")


def test_a_motion_that_nobody_has_asked_for_is_no_failure() -> None:
    gap = missing("", [FINISHED, Result.missing()])
    assert gap is not None
    assert (gap.verdict, gap.reason) == (Verdict.INCONCLUSIVE, "not evaluated so far")


def test_an_engine_that_fails_is_blocked_with_its_reason() -> None:
    gap = missing("", [FINISHED, Result.blocked("crashed")])
    assert gap is not None
    assert (gap.verdict, gap.reason) == (Verdict.BLOCKED, "crashed")


def test_finished_motions_are_compared() -> None:
    assert missing("", [FINISHED, FINISHED]) is None
