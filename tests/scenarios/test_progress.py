"""Progress: each question counted once, totals that grow with what is asked."""

from collections.abc import Sequence
from concurrent.futures import Future
from pathlib import Path

import pytest

from engines.variant import Variant
from scenarios import isolation
from scenarios.figure3 import CONVERGED, REFERENCE, Figure3
from scenarios.isolation import LocalCrew
from scenarios.progress import Bars, CountingEvaluator
from scenarios.questions import Answer, Question
from scenarios.store import ResultStore


class CountedBars(Bars):
    """Bars that only count."""

    def __init__(self) -> None:
        self.total: dict[Variant, int] = {}
        self.done: dict[Variant, int] = {}

    def expect(self, variant: Variant, count: int) -> None:
        self.total[variant] = self.total.get(variant, 0) + count

    def advance(self, variant: Variant, count: int) -> None:
        self.done[variant] = self.done.get(variant, 0) + count

    recall = advance


def answer_everything(batch: Sequence[Question]) -> list[Answer]:
    return [Answer(status="converged", transmittance_db=question.frequency_ratio) for question in batch]


class HereAndNow:
    """A pool of processes that answers in this one."""

    def __init__(self, *_arguments: object, **_options: object) -> None: ...

    def submit(self, function: object, batch: Sequence[Question], *_limit: object) -> Future[list[Answer]]:
        done: Future[list[Answer]] = Future()
        done.set_result(answer_everything(batch))
        return done

    def shutdown(self, **_options: object) -> None: ...


def test_the_grid_is_expected_from_the_start_and_a_question_counts_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(isolation, "ProcessPoolExecutor", HereAndNow)
    asked = Figure3(variants=(), friction_ratios=(0.0, 0.3), frequency_ratios=(0.5, 0.7))
    bars = CountedBars()
    with (
        ResultStore(tmp_path / "s.sqlite") as store,
        CountingEvaluator(store, LocalCrew(1), asked.grid, bars) as evaluator,
    ):
        assert bars.total == {CONVERGED: 4, REFERENCE: 4}
        on_grid = asked.question(REFERENCE, 0.3, 0.5)
        added = asked.question(REFERENCE, 0.3, 0.6)
        answers = evaluator.evaluate([on_grid, added, on_grid])
        evaluator.evaluate([added])
    assert [answer.transmittance_db for answer in answers] == [0.5, 0.6, 0.5]
    assert bars.total[REFERENCE] == 5
    assert bars.done == {REFERENCE: 2}
