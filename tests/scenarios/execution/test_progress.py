"""Progress: each question counted once, totals that grow with what is asked."""

from collections.abc import Sequence
from concurrent.futures import Future
from pathlib import Path

import pytest

from engines.interface.variant import Variant
from scenarios.execution import local_processes as isolation
from scenarios.execution.local_processes import LocalExecutor
from scenarios.execution.progress import Bars, CountingEvaluator, Pace
from scenarios.execution.store import ResultStore
from scenarios.studies.figure3 import CONVERGED, REFERENCE, Figure3
from scenarios.tasks.result import Result
from scenarios.tasks.task import SteadyStateTask


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


def answer_everything(batch: Sequence[SteadyStateTask]) -> list[Result]:
    return [Result(status="converged", transmittance_db=question.frequency_ratio) for question in batch]


class HereAndNow:
    """A pool of processes that answers in this one."""

    def __init__(self, *_arguments: object, **_options: object) -> None: ...

    def submit(self, *arguments: object) -> Future[list[Result]]:
        batch = next(one for one in arguments if isinstance(one, list))
        done: Future[list[Result]] = Future()
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
        CountingEvaluator(store, LocalExecutor(1), asked.grid, bars) as evaluator,
    ):
        assert bars.total == {CONVERGED: 4, REFERENCE: 12}
        on_grid = asked.question(REFERENCE, 0.3, 0.5)
        added = asked.question(REFERENCE, 0.3, 0.6)
        answers = evaluator.evaluate([on_grid, added, on_grid])
        evaluator.evaluate([added])
    assert [answer.transmittance_db for answer in answers] == [0.5, 0.6, 0.5]
    assert bars.total[REFERENCE] == 13
    assert bars.done == {REFERENCE: 2}


def test_remaining_time_is_that_of_the_points_computed_in_this_run() -> None:
    """Ten points in five seconds; the thousand that the store knew do not count, nor does the time since."""
    pace = Pace(begin=100.0)
    assert pace.remaining(40) is None
    pace.add(4, now=102.0)
    pace.add(6, now=105.0)
    assert pace.remaining(40) == pytest.approx(20.0)


def test_bar_begins_its_pace_when_the_variant_before_has_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = iter([0.0, 10.0, 11.0, 21.0])
    monkeypatch.setattr("scenarios.execution.progress.time.monotonic", lambda: next(clock))
    first, second = Variant("reference"), Variant("mujoco")
    monkeypatch.setattr("scenarios.execution.progress.Progress", _Silent)
    bars = Bars([first, second])
    bars.advance(first, 5)
    bars.recall(second, 100)
    bars.advance(second, 2)
    assert bars._paces[first].remaining(1) == pytest.approx(2.0)
    assert bars._paces[second].remaining(1) == pytest.approx(5.0)


class _Silent:
    """Bars that are not drawn."""

    def __init__(self, *_columns: object, **_options: object) -> None: ...

    def add_task(self, _title: str, total: int) -> int:
        return total

    def advance(self, _task: int, _count: int) -> None: ...

    def update(self, _task: int, **_fields: object) -> None: ...
