"""Motions that are not there: those that failed are blocked, those that nobody has asked for are inconclusive."""

from scenarios.tasks.result import Result
from scenarios.verdicts.judge import missing
from scenarios.verdicts.verdict import Verdict

FINISHED = Result(status="finished")


def test_a_motion_that_nobody_has_asked_for_is_no_failure() -> None:
    found = missing("", [FINISHED, Result.missing()])
    assert found is not None
    assert (found.verdict, found.reason) == (Verdict.INCONCLUSIVE, "not evaluated so far")


def test_an_engine_that_fails_is_blocked_with_its_reason() -> None:
    found = missing("", [FINISHED, Result.blocked("crashed")])
    assert found is not None
    assert (found.verdict, found.reason) == (Verdict.BLOCKED, "crashed")


def test_finished_motions_are_compared() -> None:
    assert missing("", [FINISHED, FINISHED]) is None
