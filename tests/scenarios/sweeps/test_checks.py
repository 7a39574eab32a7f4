"""Samples find steady states that depend on where their search began, and models that are none of their engine."""

import dataclasses
import math

import numpy as np
import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.recorded import RecordedPeriod
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.store import opened_store
from multibody_xval.scenarios.runs.task import Recorded, Start, SteadyStateTask
from multibody_xval.scenarios.studies.figure3 import figure3
from multibody_xval.scenarios.sweeps.attenuation_band import Edge
from multibody_xval.scenarios.sweeps.checks import Check, _difference, check_models, check_starts
from multibody_xval.scenarios.sweeps.compared import ComparedSweep, compare_sweep
from multibody_xval.scenarios.sweeps.point import Point, evaluated, judged
from multibody_xval.scenarios.verdicts.finding import TRANSMITTANCE, Verdict
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE
from tests.scenarios.in_process import evaluator

needs_pymunk = pytest.mark.needs("pymunk")
needs_mujoco = pytest.mark.needs("mujoco")

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


def checked(eta: float, least: int, status: str = "converged") -> tuple[ComparedSweep, Check, list[float]]:
    with opened_store(None) as store, evaluator(store) as running:
        bistable, result = Bistable(running, eta, status), compare_sweep(SWEEP, running)
        points, (check,) = check_starts(SWEEP, result.points, bistable, least)
    return dataclasses.replace(result, points=points), check, bistable.balanced


def verdicts(result: ComparedSweep) -> dict[float, Verdict]:
    return {point.frequency_ratio: point.comparison.verdict for point in result.points_of(SHARES)}


@needs_pymunk
def test_one_steady_state_is_found_from_wherever_the_search_begins() -> None:
    result, check, balanced = checked(math.nan, 2)
    assert check == Check(SHARES, 2, 0)
    assert len(balanced) == 2
    assert set(verdicts(result).values()) == {Verdict.AGREE}


@needs_pymunk
def test_a_second_steady_state_has_all_points_searched_both_ways_and_its_own_inconclusive() -> None:
    first = checked(math.nan, 1)[2][0]
    result, check, balanced = checked(first, 1)
    assert sorted(balanced) == sorted(verdicts(result)), "the grid as it was resolved"
    assert (check.compared, check.differing) == (len(balanced), 1)
    own = verdicts(result)
    assert own.pop(first) is Verdict.INCONCLUSIVE
    assert set(own.values()) == {Verdict.AGREE}
    (point,) = [point for point in result.points_of(SHARES) if point.frequency_ratio == first]
    assert "another steady state, of" in point.comparison.reason


@needs_pymunk
def test_a_search_that_fails_from_elsewhere_says_nothing() -> None:
    first = checked(math.nan, 1)[2][0]
    result, check, balanced = checked(first, 1, "period limit")
    assert len(balanced) == 1
    assert check == Check(SHARES, 0, 0)
    assert set(verdicts(result).values()) == {Verdict.AGREE}


@needs_mujoco
def test_two_steady_states_are_one_where_no_verdict_tells_them_apart(running) -> None:
    (found,) = [point for point in compare_sweep(POINTS, running, 1).points_of(LAWFUL) if point.frequency_ratio == 0.9]

    def end(db: float) -> Result:
        level = found.converged.transmittance_db + db
        return dataclasses.replace(found.result, transmittance_db=level, phase=found.converged.phase)

    (agrees,) = judged([dataclasses.replace(found, result=end(0.0))])
    assert (found.comparison.verdict, agrees.comparison.verdict) == (Verdict.DISAGREE, Verdict.AGREE)
    allowed = agrees.allowed(TRANSMITTANCE)
    assert allowed > 1000 * agrees.left_open
    off = found.difference(TRANSMITTANCE)
    turned = dataclasses.replace(
        found.result, transmittance_db=found.result.transmittance_db + 0.9 * found.allowed(TRANSMITTANCE)
    )
    assert _difference(found, turned) == _difference(agrees, end(0.9 * allowed)) == ""
    assert _difference(agrees, dataclasses.replace(end(0.0), status="period limit")) is None
    for one, other in ((found, end(0.0)), (found, end(off - 9.0)), (agrees, end(1.1 * allowed)), (agrees, end(9.0))):
        assert "another steady state, of" in _difference(one, other)


@pytest.mark.slow
@pytest.mark.needs("exudyn-bristle")
def test_two_steady_states_of_a_bristle_differ_in_where_inner_masses_rest(running) -> None:
    task = SteadyStateTask(
        variant=Variant("exudyn-bristle"), friction_ratio=0.3, frequency_ratio=0.7437, recorded=Recorded.PERIOD
    )
    results = running.evaluate([task, dataclasses.replace(task, start=Start.HARMONIC_BALANCE)])
    one, other = (RecordedPeriod.of_result(result) for result in results)
    apart = abs(np.mean(one.inner - other.inner, axis=0))
    assert 0.01 < np.max(apart) < 0.03
    assert np.max(abs(one.inner - other.inner)) < 1.02 * np.max(apart), "they are apart by that all the time"
    assert 0 < abs(results[0].transmittance_db - results[1].transmittance_db) < 3e-5


LAWFUL = Variant("mujoco", "joint", "default")
"""Its model stands in for it at all of these points."""
LAW = LAWFUL.law
POINTS = figure3((LAWFUL,), (0.3,), (0.55, 0.7, 0.9, 1.1))
HALF = 200


class Spoilt:
    """Runs tasks, changes results of one variant at one number of steps, and notes who was asked for how many."""

    spoilt = LAWFUL

    def __init__(self, running, steps: int = HALF, etas: tuple[float, ...] = (), **changes):
        self.running, self.steps, self.etas, self.changes = running, steps, etas, changes
        self.asked: dict[tuple[Variant, int], set[float]] = {}

    def evaluate(self, tasks):
        return [self._seen(*pair) for pair in zip(tasks, self.running.evaluate(tasks), strict=True)]

    def _seen(self, task, result):
        key = task.variant, task.steps_per_period
        self.asked.setdefault(key, set()).add(task.frequency_ratio)
        spoilt = key == (self.spoilt, self.steps) and task.frequency_ratio in self.etas
        return dataclasses.replace(result, **self.changes) if spoilt else result

    def of(self, variant: Variant | None) -> set[float]:
        """Frequency ratios at which a variant was asked with half as many steps."""
        assert variant is not None
        return self.asked.get((variant, HALF), set())


@pytest.fixture
def running():
    with opened_store(None) as store, evaluator(store) as own:
        yield own


def models_of(spoilt: Spoilt, least: int) -> tuple[dict[float, Point], Check]:
    points, (check,) = check_models(POINTS, list(POINTS.grid_points()), spoilt, least)
    return {point.frequency_ratio: point for point in points if point.variant == LAWFUL}, check


@needs_mujoco
def test_a_model_stands_in_for_its_engine_and_a_sample_is_run_by_both(running) -> None:
    spoilt = Spoilt(running)
    points, check = models_of(spoilt, 2)
    assert check == Check(LAWFUL, 2, 0)
    assert spoilt.of(LAW) == set(points)
    assert len(spoilt.of(LAWFUL)) == 2
    assert all(point.modelled for point in points.values())
    own = evaluated(POINTS, [point.place for point in points.values()], running)
    for point, by_engine in zip(points.values(), own, strict=True):
        (modelled,), (given,) = point.others, by_engine.others
        assert modelled.steps_per_period == given.steps_per_period == HALF
        assert modelled.transmittance_db != given.transmittance_db, "they differ by round-off at least"
        assert modelled.transmittance_db == pytest.approx(given.transmittance_db, abs=1e-5)


@needs_mujoco
@pytest.mark.parametrize("changes", [{"phase": 0.1}, {"status": "period limit"}, {"status": "blocked"}])
def test_an_engine_that_differs_from_its_model_at_other_steps_gives_all_points_itself(running, changes) -> None:
    models_of(sound := Spoilt(running), 1)
    (first,) = sound.of(LAWFUL)
    spoilt = Spoilt(running, HALF, (first,), **changes)
    points, check = models_of(spoilt, 1)
    assert check == Check(LAWFUL, len(points), 1)
    assert not any(point.modelled for point in points.values())
    assert spoilt.of(LAWFUL) == set(points)
    (other,) = points[first].others
    assert {name: getattr(other, name) for name in changes} == changes


@needs_mujoco
def test_a_sample_that_cannot_be_compared_confirms_no_model(running) -> None:
    spoilt = Spoilt(running, HALF, POINTS.frequency_ratios, status="missing")
    points, check = models_of(spoilt, 2)
    assert check == Check(LAWFUL, 0, 0)
    assert not any(point.modelled for point in points.values())


@needs_mujoco
@pytest.mark.parametrize("changes", [{"periods": 2}, {"status": "period limit"}])
def test_a_point_whose_engine_has_not_come_back_in_one_period_is_asked_of_the_engine(running, changes) -> None:
    spoilt = Spoilt(running, 2 * HALF, (0.9,), **changes)
    points, check = models_of(spoilt, 1)
    assert check == Check(LAWFUL, 1, 0)
    assert {eta for eta, point in points.items() if not point.modelled} == {0.9} <= spoilt.of(LAWFUL)
    assert 0.9 not in spoilt.of(LAW)


@needs_mujoco
@pytest.mark.parametrize("status", ["period limit", "diverged", "blocked"])
def test_a_point_with_nothing_to_compare_is_asked_nothing_more(running, status) -> None:
    spoilt = Spoilt(running, 2 * HALF, (0.9,), status=status, residual=1.0)
    points, _ = models_of(spoilt, 1)
    assert points[0.9].others == ()
    assert 0.9 not in spoilt.of(LAW) | spoilt.of(LAWFUL)
    refined = Spoilt(running, 2 * HALF, (0.9,), status=status)
    refined.spoilt = REFERENCE
    assert all(point.refined for point in models_of(refined, 1)[0].values()), "others are judged by those"


@needs_mujoco
def test_a_point_that_the_law_does_not_claim_is_asked_of_the_engine(running, monkeypatch) -> None:
    monkeypatch.setattr("multibody_xval.scenarios.sweeps.point.unclaimed_reason", lambda *_: "it says nothing of it")
    places = list(POINTS.grid_points())
    _, checks = check_models(POINTS, places, spoilt := Spoilt(running), 1)
    assert checks == ()
    assert spoilt.of(LAW) == set()
    assert spoilt.of(LAWFUL) == set(POINTS.frequency_ratios)


@needs_mujoco
def test_edges_ask_the_models_whose_sample_has_not_differed_and_the_engines_of_others(running) -> None:
    sweep = figure3((LAWFUL,), (0.3,), (0.55, 0.62, 0.67, 0.9, 1.1))
    result = compare_sweep(sweep, sound := Spoilt(running), 1)
    grid = {point.frequency_ratio for point in result.points}
    (edge,) = sound.of(LAW) - grid
    assert edge == result.edge(REFERENCE, sweep.cases[0], Edge.LOWER).expected
    assert edge not in sound.of(LAWFUL)
    etas = tuple(sound.of(LAWFUL))
    compare_sweep(sweep, spoilt := Spoilt(running, HALF, etas, phase=0.1), 1)
    assert {edge} == spoilt.of(LAWFUL) - grid
    assert edge not in spoilt.of(LAW)


@needs_mujoco
def test_results_of_engines_that_an_earlier_version_stored_are_taken_where_no_model_was_run(running) -> None:
    running.evaluate([POINTS.task(*place, factor) for place in POINTS.grid_points() for factor in (0.5, 1, 2, 4)])
    stored = Spoilt(running)
    running.evaluate = lambda tasks: [running._results.get(task) or Result.missing() for task in tasks]
    points, check = models_of(stored, 2)
    assert check == Check(LAWFUL, 0, 0)
    assert all(other.converged for point in points.values() for other in point.others)
