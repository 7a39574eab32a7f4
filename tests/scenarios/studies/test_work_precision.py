"""What accuracy costs: the Euler scheme's error halves with its step, and what is missing is said."""

import math
from pathlib import Path

import pytest

from engines.interface.variant import Variant
from reference_lcp.accuracy.convergence import STICK_SLIP_POINTS
from scenarios.execution.evaluator import StoredResults
from scenarios.execution.store import ResultStore
from scenarios.studies.accuracy import ORDER_STEPS, exact_answer
from scenarios.studies.work_precision import exact_answers, step_questions, step_study
from scenarios.tasks.parameters import Excitation
from scenarios.tasks.result import Result

REFERENCE = Variant("reference")
EXACT = {place: Result(status="converged", transmittance_db=-5.0) for place in STICK_SLIP_POINTS}


@pytest.fixture
def store(tmp_path: Path):
    with ResultStore(tmp_path / "results.sqlite") as opened:
        yield opened


def answer(steps: int, **more: object) -> Result:
    found = {"status": "converged", "transmittance_db": -5.0 + 4 / steps, "residual": 1e-9, "periods": 20}
    return Result(**{**found, "steps_per_period": steps, "seconds": steps * 20 * 3e-6, **more})


def test_error_and_cost_are_read_from_the_answers(store: ResultStore) -> None:
    store.keep((question, answer(question.steps_per_period)) for question in step_questions(REFERENCE))
    points = step_study([REFERENCE], EXACT, StoredResults(store))
    assert [point.steps_per_period for point in points] == list(ORDER_STEPS)
    for point in points:
        assert point.error_db == pytest.approx(4 / point.steps_per_period)
        assert point.step_seconds == pytest.approx(3e-6)
        assert point.seconds == pytest.approx(point.steps_per_period * 20 * 3e-6)
        assert (point.certified, point.answered) == (6, 6)


def test_points_without_a_steady_state_and_missing_ones_are_counted(store: ResultStore) -> None:
    questions = [question for question in step_questions(REFERENCE) if question.steps_per_period == 400]
    statuses = ["converged", "period limit", "diverged"]
    store.keep((q, answer(400, status=status)) for q, status in zip(questions, statuses, strict=False))
    coarse, *finer = step_study([REFERENCE], EXACT, StoredResults(store))
    assert (coarse.certified, coarse.answered) == (1, 3)
    assert [point.answered for point in finer] == [0, 0]
    assert all(math.isnan(point.error_db) for point in finer)


def test_the_exact_motion_is_computed_once_and_kept(store: ResultStore, monkeypatch: pytest.MonkeyPatch) -> None:
    place = (0.3, 0.9)
    assert exact_answers([place], store, ask=False) == {}
    first = exact_answers([place], store, workers=1)[place]
    assert first.transmittance_db == pytest.approx(exact_answer(place).transmittance_db, abs=1e-12)
    assert exact_answers([place], store, ask=False)[place].transitions == first.transitions
    store_of_engines = [q for q in step_questions(REFERENCE) if store.find(q) is not None]
    assert store_of_engines == []  # it is no answer of the reference


def test_another_drive_asks_other_questions_and_has_an_exact_motion_of_its_own(store: ResultStore) -> None:
    force = Excitation(kind="force", amplitude=10.0)
    questions = step_questions(REFERENCE, force)
    assert {question.excitation for question in questions} == {force}
    store.keep((question, answer(question.steps_per_period)) for question in questions)
    assert {point.answered for point in step_study([REFERENCE], EXACT, StoredResults(store))} == {0}
    assert {point.answered for point in step_study([REFERENCE], EXACT, StoredResults(store), force)} == {6}
    place = (0.3, 0.9)
    pushed = exact_answers([place], store, excitation=force, workers=1)[place]
    assert pushed.transmittance_db == pytest.approx(exact_answer(place, force).transmittance_db, abs=1e-12)
    assert pushed.transitions != exact_answer(place).transitions
    assert exact_answers([place], store, ask=False) == {}
