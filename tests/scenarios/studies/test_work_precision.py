"""What accuracy costs: the Euler scheme's error halves with its step, and what is missing is said."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.evaluator import Evaluator, StoredResults
from multibody_xval.scenarios.runs.executor import InProcessExecutor, run_batch
from multibody_xval.scenarios.runs.parameters import Excitation
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.store import ResultStore
from multibody_xval.scenarios.runs.task import DEFAULT_EXCITATION, SteadyStateTask
from multibody_xval.scenarios.studies.accuracy import ORDER_STEPS
from multibody_xval.scenarios.studies.work_precision import (
    FINEST_STEPS,
    PRINTED_COLUMNS,
    STUDY_STEPS,
    StepPoint,
    coarse_steps,
    exact_step_tasks,
    remarks,
    step_study,
    step_tasks,
    thrifty_step_study,
)
from multibody_xval.scenarios.tables import text_table
from multibody_xval.scenarios.verdicts.proven import proven_level
from reference_lcp import Chain, exact_steady_state
from reference_lcp.defaults import EXACT_RESIDUAL
from tests.scenarios.runs.builders import certified

REFERENCE = Variant("reference")
EXACT = certified(cells=7, transmittance_db=-5.0)


def with_exact(store: ResultStore) -> ResultStore:
    store.keep((task, EXACT) for task in exact_step_tasks())
    return store


@pytest.fixture
def store(tmp_path: Path):
    with ResultStore(tmp_path / "results.sqlite") as opened:
        yield opened


@pytest.fixture
def nothing_proven(monkeypatch: pytest.MonkeyPatch) -> None:
    """The exact level is invented."""
    monkeypatch.setattr("multibody_xval.scenarios.studies.work_precision.with_proven_level", lambda _, result: result)


def answer(steps: int, **more: object) -> Result:
    result = {"transmittance_db": -5.0 + 4 / steps, "residual": 1e-9, "periods": 20}
    return certified(cells=7, **{**result, "steps_per_period": steps, "seconds": steps * 20 * 3e-6, **more})


@pytest.mark.usefixtures("nothing_proven")
def test_error_and_cost_are_read_from_the_answers(store: ResultStore) -> None:
    store.keep((task, answer(task.steps_per_period)) for task in step_tasks(REFERENCE))
    points = step_study([REFERENCE], StoredResults(with_exact(store)))
    assert [point.steps_per_period for point in points] == list(ORDER_STEPS)
    for point in points:
        assert point.error_db == pytest.approx(4 / point.steps_per_period)
        assert point.step_seconds == pytest.approx(3e-6)
        assert point.seconds == pytest.approx(point.steps_per_period * 20 * 3e-6)
        assert (point.certified, point.evaluated) == (6, 6)


def test_errors_are_those_to_the_proven_levels(store: ResultStore) -> None:
    store.keep((task, answer(task.steps_per_period)) for task in step_tasks(REFERENCE))
    points = step_study([REFERENCE], StoredResults(with_exact(store)))
    levels = [proven_level(task) for task in exact_step_tasks()]
    assert None not in levels
    farthest = max(abs(-5 + 4 / ORDER_STEPS[0] - float(level.transmittance_db)) for level in levels)
    assert points[0].error_db == pytest.approx(farthest)


def test_points_without_a_steady_state_and_missing_ones_are_counted(store: ResultStore) -> None:
    tasks = [task for task in step_tasks(REFERENCE) if task.steps_per_period == 400]
    statuses = ["converged", "period limit", "diverged"]
    store.keep((q, answer(400, status=status)) for q, status in zip(tasks, statuses, strict=False))
    coarse, *finer = step_study([REFERENCE], StoredResults(with_exact(store)))
    assert (coarse.certified, coarse.evaluated) == (1, 3)
    assert [point.evaluated for point in finer] == [0, 0]
    assert all(math.isnan(point.error_db) for point in finer)


def test_the_exact_motion_is_a_preset_of_the_reference_whose_results_are_kept(store: ResultStore) -> None:
    """Solved by Newton's method and read from its events, as `exact_steady_state` does."""
    task = exact_step_tasks()[0]
    assert str(task.variant) == "reference:joint:exact"
    (result,) = Evaluator(store, InProcessExecutor()).evaluate([task])
    expected = exact_steady_state(*task.setting())
    assert result.transmittance_db == expected.transmittance_db
    assert result.residual == expected.orbit.residual < EXACT_RESIDUAL
    assert [time for _, time, _ in result.transitions] == [change.time for change in expected.transitions]
    assert len(result.series["travels"]) == len(result.transitions)
    assert store.find(task) == result
    assert [task for task in step_tasks(REFERENCE) if store.find(task) is not None] == []


def test_another_drive_has_other_tasks_and_an_exact_motion_of_its_own(store: ResultStore) -> None:
    force = Excitation(kind="force", amplitude=10.0)
    tasks = [*step_tasks(REFERENCE, force), *exact_step_tasks(force)]
    assert {task.excitation for task in tasks} == {force}
    store.keep((task, answer(task.steps_per_period)) for task in tasks)
    assert {point.evaluated for point in step_study([REFERENCE], StoredResults(store))} == {0}
    assert {point.evaluated for point in step_study([REFERENCE], StoredResults(store), force)} == {6}
    moved, pushed = run_batch([exact_step_tasks()[0], exact_step_tasks(force)[0]])
    assert pushed.transmittance_db == pytest.approx(
        exact_steady_state(*exact_step_tasks(force)[0].setting()).transmittance_db, abs=1e-12
    )
    assert pushed.transitions != moved.transitions


@pytest.mark.usefixtures("nothing_proven")
def test_other_numbers_of_steps_than_those_of_the_order_are_a_study_too(store: ResultStore) -> None:
    store.keep((task, answer(task.steps_per_period)) for task in step_tasks(REFERENCE, steps=(50, 6400)))
    points = step_study([REFERENCE], StoredResults(with_exact(store)), steps=STUDY_STEPS)
    assert [point.steps_per_period for point in points] == [50, 100, 200, 400, 800, 1600, 3200, 6400]
    assert [point.evaluated for point in points] == [6, 0, 0, 0, 0, 0, 0, 6]
    assert points[0].error_db == pytest.approx(4 / 50)
    assert points[-1].error_db == pytest.approx(4 / 6400)


@pytest.mark.usefixtures("nothing_proven")
def test_the_finest_steps_are_not_run_where_the_error_of_a_law_stays(store: ResultStore) -> None:
    """A law that is off by 0.3 dB is off at every step; what is known of it already is shown all the same."""
    off = Variant("mujoco", "joint", "default")
    asked: list[tuple[Variant, int]] = []

    class Answers(StoredResults):
        def evaluate(self, tasks: Sequence[SteadyStateTask]) -> list[Result]:
            asked.extend((task.variant, task.steps_per_period) for task in tasks if task.variant in (REFERENCE, off))
            errors = {REFERENCE: 0.0, off: 0.3}
            return [
                answer(task.steps_per_period, transmittance_db=-5 + 4 / task.steps_per_period + errors[task.variant])
                if task.variant in errors
                else EXACT
                for task in tasks
            ]

    store.keep((task, answer(6400)) for task in step_tasks(off, steps=(6400,)))
    with_exact(store)
    study = thrifty_step_study([off, REFERENCE], Answers(store), StoredResults(store), DEFAULT_EXCITATION, STUDY_STEPS)
    assert {steps for variant, steps in asked if variant == off} == {50, 100, 200, 400, 800, 1600}
    assert {steps for variant, steps in asked if variant == REFERENCE} == set(STUDY_STEPS)
    assert [point.steps_per_period for point in study if point.variant == off] == [50, 100, 200, 400, 800, 1600, 6400]


def test_finest_steps_are_none_of_the_coarse_ones() -> None:
    assert coarse_steps([50, *FINEST_STEPS, 400]) == [50, 400]


def point(steps: int, error_db: float, **more: Any) -> StepPoint:
    own = {"step_seconds": 1e-6, "seconds": 0.1, "certified": 6, "evaluated": 6, "reason": "", **more}
    return StepPoint(variant=own.pop("variant", REFERENCE), steps_per_period=steps, error_db=error_db, **own)


def drive_frequency() -> float:
    """Of the point at which steps are timed [Hz]."""
    return 0.9 * Chain.from_ratios(friction_ratio=0.3).resonator_frequency / (2 * math.pi)


@pytest.mark.parametrize("steps", [50, 400, 6400])
def test_a_simulated_second_takes_the_time_of_all_its_steps(steps: int) -> None:
    own = point(steps, 0.1, step_seconds=2e-6)
    assert own.simulated_second == pytest.approx(2e-6 * steps * drive_frequency(), rel=1e-12)


def test_steps_that_the_highest_mode_needs_are_paid_for() -> None:
    asked = 2e-6 * 16 * drive_frequency()
    assert point(16, 0.1, step_seconds=2e-6).simulated_second > 1.5 * asked


def test_a_printed_row_is_error_times_time_of_its_point() -> None:
    own = point(400, 0.25, step_seconds=2e-3 / (400 * drive_frequency()))
    (row,) = text_table(PRINTED_COLUMNS, [own]).itertuples(index=False, name=None)
    assert row == ("reference", "400", "0.25", "2", "0.5", "6/6")


def test_an_error_over_fewer_points_has_no_product_with_the_time() -> None:
    (row,) = text_table(PRINTED_COLUMNS, [point(400, 0.25, certified=5)]).itertuples(index=False, name=None)
    assert row[-2:] == ("–", "5/6")


def test_an_error_that_does_not_fall_with_the_step_is_said_and_one_of_first_order_is_not() -> None:
    off = Variant("mujoco", "joint", "default")
    first_order = [point(400, 0.2), point(800, 0.1)]
    assert remarks(first_order) == []
    stays = [point(400, 1.01, variant=off), point(800, 0.997, variant=off)]
    assert remarks([*first_order, *stays]) == [
        "mujoco:joint:default: the error does not fall with the step: 1.01 dB at 400 steps a period, 0.997 dB at 800"
    ]


@pytest.mark.parametrize(("error_db", "count"), [(0.89, 0), (0.91, 1)])
def test_an_error_has_to_fall_at_every_doubling_of_the_steps(error_db: float, count: int) -> None:
    assert len(remarks([point(50, 1.0), point(100, error_db)])) == count
    assert len(remarks([point(50, 1.0), point(400, error_db**3)])) == count


def test_an_error_that_stays_is_said_beside_steps_that_lack_points_and_not_compared_with_theirs() -> None:
    lacking = point(400, 1.0, certified=4)
    last = "reference: the error does not fall with the step: 1 dB at 100 steps a period, 1 dB at 200"
    assert remarks([point(100, 1.0), point(200, 1.0), lacking])[1:] == [last]
    assert len(remarks([point(200, 1.0), lacking])) == 1


def test_points_that_are_missing_have_a_reason() -> None:
    lost = Variant("mujoco")
    every = [
        *(point(n, 0.1, certified=certified) for n, certified in ((50, 5), (100, 6), (200, 0))),
        point(50, math.nan, variant=lost, certified=0, evaluated=0, reason="crashed"),
    ]
    assert remarks(every) == [
        "reference: not all of the six points are certified at 50, 200 steps a period",
        "mujoco: blocked: crashed",
    ]
