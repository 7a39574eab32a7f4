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


def task(variant: Variant, friction: float, eta: float, steps: int = 400) -> SteadyStateTask:
    return SteadyStateTask(variant=variant, friction_ratio=friction, frequency_ratio=eta, steps_per_period=steps)


def grid(*frictions: float) -> list[SteadyStateTask]:
    """The reference with two numbers of steps, and its converged preset, at two frequencies."""
    kinds = ((CONVERGED, 400), (REFERENCE, 400), (REFERENCE, 800))
    return [task(variant, own, eta, steps) for variant, steps in kinds for own in frictions for eta in (0.5, 0.7)]


def test_the_grid_is_expected_from_the_start_and_a_task_counts_once(store) -> None:
    bars = ProgressBars((), grid(0.0, 0.3))
    assert counts(bars) == {CONVERGED.title: (0, 4), REFERENCE.title: (0, 8)}
    on_grid, added = task(REFERENCE, 0.3, 0.5), task(REFERENCE, 0.3, 0.6)
    with Evaluator(store, invented(), bars) as evaluator:
        answers = evaluator.evaluate([on_grid, added, on_grid])
        evaluator.evaluate([added])
    assert [answer.transmittance_db for answer in answers] == [0.5, 0.6, 0.5]
    assert counts(bars) == {CONVERGED.title: (0, 4), REFERENCE.title: (2, 9)}


def test_what_is_looked_up_again_counts_once(store) -> None:
    """A command completes its points, and reads them again to judge them."""
    tasks = grid(0.3)
    bars = ProgressBars((), tasks)
    with Evaluator(store, invented(), bars) as evaluator:
        evaluator.complete(tasks)
        evaluator.evaluate(tasks)
    assert counts(bars) == {CONVERGED.title: (2, 2), REFERENCE.title: (4, 4)}


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
