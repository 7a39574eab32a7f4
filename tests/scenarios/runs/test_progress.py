"""Progress: each task counted once, totals that grow with what is asked."""

import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.progress import ProgressBars
from multibody_xval.scenarios.runs.task import SteadyStateTask
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED, REFERENCE
from tests.scenarios.runs.builders import Invented, certified, steady


def counts(bars: ProgressBars) -> dict[str, tuple[int, int]]:
    """Points that are done, and all that are wanted, by the title of their variant."""
    known = {bar.description: bar.fields["known"] for bar in bars.progress.tasks}
    return {
        bar.description: (bar.completed + known[bar.description], bar.total + known[bar.description])
        for bar in bars.progress.tasks
    }


def invented() -> Invented:
    return Invented(lambda task: certified(task.cells, transmittance_db=task.frequency_ratio))


def asked(*ratios: float) -> list[SteadyStateTask]:
    """Points of the reference, and of its converged preset."""
    return [steady(eta, variant=own) for own in (REFERENCE, CONVERGED) for eta in ratios]


def test_what_is_planned_is_expected_from_the_start_and_a_task_counts_once(store) -> None:
    bars = ProgressBars((), asked(0.5, 0.7))
    assert counts(bars) == {REFERENCE.title: (0, 2), CONVERGED.title: (0, 2)}
    planned, added = steady(0.5, variant=REFERENCE), steady(0.6, variant=REFERENCE)
    with Evaluator(store, invented(), bars) as evaluator:
        answers = evaluator.evaluate([planned, added, planned])
        evaluator.evaluate([added])
    assert [answer.transmittance_db for answer in answers] == [0.5, 0.6, 0.5]
    assert counts(bars) == {REFERENCE.title: (2, 3), CONVERGED.title: (0, 2)}


def test_what_is_looked_up_again_counts_once(store) -> None:
    tasks = asked(0.5, 0.7)
    bars = ProgressBars((), tasks)
    with Evaluator(store, invented(), bars) as evaluator:
        evaluator.complete(tasks)
        evaluator.evaluate(tasks)
    assert counts(bars) == {REFERENCE.title: (2, 2), CONVERGED.title: (2, 2)}


class Clock:
    """Time as a test sets it."""

    now = 100.0

    def __call__(self) -> float:
        return self.now


def test_remaining_time_is_that_of_the_points_computed_in_this_run() -> None:
    """Ten points in five seconds; the thousand that the store knew do not count, nor does the time before the first."""
    clock, variant = Clock(), Variant("reference")
    bars = ProgressBars([variant], clock=clock)
    bars.expect_points(variant, 1054)
    bars.recall([steady()] * 1000)
    (bar,) = bars.progress.tasks
    assert (bar.completed, bar.total, bar.fields["known"]) == (0, 54, 1000)
    assert bar.time_remaining is None
    assert bar.fields["counts"] == "1,000/1,054 points, 1000 known"
    for now, count in ((160.0, 4), (162.0, 4), (165.0, 6)):
        clock.now = now
        bars.advance([steady()] * count)
    assert bar.completed == 14
    assert bar.time_remaining == pytest.approx(40 * 5 / 10)


def test_each_variant_has_a_bar_and_a_pace_of_its_own() -> None:
    clock, first, second = Clock(), Variant("reference"), Variant("mujoco")
    bars = ProgressBars([first], clock=clock)
    for variant in (first, second):
        bars.expect_points(variant, 10)
    for now, variant in ((101.0, first), (102.0, first), (103.0, second), (108.0, second)):
        clock.now = now
        bars.advance([steady(variant=variant)])
    assert [bar.description for bar in bars.progress.tasks] == [first.title, second.title]
    assert [bar.time_remaining for bar in bars.progress.tasks] == [8, 8 * 5]
