"""Steady states that depend on where their search began are found by a sample, and left inconclusive."""

import dataclasses
import math
from types import SimpleNamespace
from unittest.mock import patch

import pytest

from engines.interface.variant import Variant
from scenarios.runs.result import Result
from scenarios.runs.store import opened_store
from scenarios.runs.task import Start
from scenarios.studies.figure3 import figure3
from scenarios.sweeps.compared import ComparedSweep, compare_sweep
from scenarios.sweeps.start_check import StartCheck, _difference, check_starts
from scenarios.verdicts.finding import Verdict
from tests.scenarios.in_process import evaluator

pytestmark = pytest.mark.needs("pymunk")

SHARES = Variant("pymunk")
SWEEP = figure3((SHARES,), (0.3,), (0.5, 0.62, 0.9, 1.1))


class Bistable:
    """Runs tasks; from harmonic balance a variant ends a dB lower at one frequency, or nowhere."""

    def __init__(self, running, eta: float, status: str = "converged"):
        self.running, self.eta, self.status = running, eta, status
        self.balanced: list[float] = []

    def evaluate(self, tasks):
        return [self._seen(*pair) for pair in zip(tasks, self.running.evaluate(tasks), strict=True)]

    def _seen(self, task, result):
        if task.start is Start.LAW:
            return result
        self.balanced.append(task.frequency_ratio)
        if task.frequency_ratio != self.eta:
            return result
        return dataclasses.replace(result, status=self.status, transmittance_db=result.transmittance_db - 1)


def checked(eta: float, least: int, status: str = "converged") -> tuple[ComparedSweep, StartCheck, list[float]]:
    with opened_store(None) as store, evaluator(store) as running:
        bistable = Bistable(running, eta, status)
        result, (check,) = check_starts(compare_sweep(SWEEP, running), bistable, least)
    return result, check, bistable.balanced


def test_two_motions_that_are_equal_are_one_however_exactly_they_are_known() -> None:
    known = Result(status="converged", transmittance_db=0.0, phase=0.0, period=1.0)
    exact = SimpleNamespace(result=known, left_open=0.0)
    with patch("scenarios.sweeps.start_check.replace", lambda point, **_: point):
        assert _difference(exact, known) == ""
        assert "of 1e-09 dB, from" in _difference(exact, dataclasses.replace(known, transmittance_db=1e-9))


def verdicts(result: ComparedSweep) -> dict[float, Verdict]:
    return {point.frequency_ratio: point.comparison.verdict for point in result.points_of(SHARES)}


def test_one_steady_state_is_found_from_wherever_the_search_begins() -> None:
    result, check, balanced = checked(math.nan, 2)
    assert check == StartCheck(SHARES, 2, 0)
    assert len(balanced) == 2
    assert set(verdicts(result).values()) == {Verdict.AGREE}


def test_a_second_steady_state_has_all_points_searched_both_ways_and_its_own_inconclusive() -> None:
    first = checked(math.nan, 1)[2][0]
    result, check, balanced = checked(first, 1)
    assert sorted(balanced) == sorted(verdicts(result)), "the grid as it was resolved"
    assert (check.searched, check.elsewhere) == (len(balanced), 1)
    own = verdicts(result)
    assert own.pop(first) is Verdict.INCONCLUSIVE
    assert set(own.values()) == {Verdict.AGREE}
    (point,) = [point for point in result.points_of(SHARES) if point.frequency_ratio == first]
    assert "another steady state, of" in point.comparison.reason


def test_a_search_that_fails_from_elsewhere_says_nothing() -> None:
    first = checked(math.nan, 1)[2][0]
    result, check, balanced = checked(first, 1, "period limit")
    assert len(balanced) == 1
    assert check == StartCheck(SHARES, 0, 0)
    assert set(verdicts(result).values()) == {Verdict.AGREE}
