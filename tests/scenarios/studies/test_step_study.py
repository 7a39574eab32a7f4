"""What accuracy costs: errors and times are read from results, steps are doubled where that still helps."""

import math
from collections.abc import Callable, Sequence

import pandas as pd
import pytest

from multibody_xval.scenarios.model import Config, Result, Run, Status, failed
from multibody_xval.scenarios.result_tables import points
from multibody_xval.scenarios.ruler.judge import judged
from multibody_xval.scenarios.ruler.proven import proven
from multibody_xval.scenarios.store import Stored
from multibody_xval.scenarios.studies.accuracy_map import SIX
from multibody_xval.scenarios.studies.step_study import (
    MOST_STEPS,
    TIMED,
    finer,
    remarks,
    step_runs,
    step_table,
)

ENGINE = Config("mujoco", preset_name="default")
A_STEP, PERIODS = 3e-6, 20


def made(
    steps: Sequence[int],
    error_db: Callable[[int], float] = lambda steps: 4 / steps,
    change: Callable[[Run, Result], Result] = lambda _, own: own,
    config: Config = ENGINE,
) -> list[Stored]:
    """Give results that are off by an error, and take some time a step."""
    runs = [run for run in step_runs([config], steps) if run.config == config and run.steps in steps]

    def result(run: Run) -> Result:
        ratio = proven()[run.case] * 10 ** (error_db(run.steps) / 20)
        seconds = A_STEP * PERIODS * run.steps
        return Result(status=Status.PERIODIC, transmittance=ratio, periods=PERIODS, seconds=seconds)

    return [Stored(run, "1", change(run, result(run))) for run in runs]


def table(stored: list[Stored]) -> pd.DataFrame:
    return step_table(judged(points(stored)))


def test_error_and_cost_are_read_from_results_by_ascending_steps() -> None:
    own = table(made([800, 100, 400]))
    assert own.steps.tolist() == [100, 400, 800]
    assert own.error_db.tolist() == pytest.approx([4 / 100, 4 / 400, 4 / 800])
    assert own.step_seconds.tolist() == pytest.approx([A_STEP] * 3)
    assert own.seconds.tolist() == pytest.approx([A_STEP * PERIODS * steps for steps in (100, 400, 800)])
    length = TIMED.lane(400).time_step
    assert own.milliseconds[1] == pytest.approx(1e3 * A_STEP / length)
    assert own["product"][1] == pytest.approx(own.error_db[1] * own.milliseconds[1])


def test_an_error_over_fewer_points_has_no_product_with_the_time_and_is_said() -> None:
    def lose(run: Run, own: Result) -> Result:
        return Result(status=Status.NOT_PERIODIC) if run.case == SIX[0] and run.steps == 50 else own

    own = table(made([50, 100], change=lose))
    assert own.periodic.tolist() == [5, 6]
    assert math.isnan(own["product"][0])
    assert remarks(own) == ["mujoco:joint:default: not all of the six points are periodic with 50 steps per period"]
    assert remarks(table(made([50], change=lambda *_: failed("crashed"))))[0].endswith("first failure: crashed")


@pytest.mark.parametrize(("error_db", "count"), [(0.89, 0), (0.91, 1)])
def test_an_error_has_to_fall_at_every_doubling_of_the_steps(error_db: float, count: int) -> None:
    assert len(remarks(table(made([50, 400], {50: 1.0, 400: error_db**3}.__getitem__)))) == count


def test_steps_are_doubled_only_where_the_error_still_falls_and_no_farther_than_the_most() -> None:
    falls = finer(points(made([400, 800])))
    assert ({run.steps for run in falls}, {run.config for run in falls}) == ({1600}, {ENGINE})
    assert finer(points(made([400, 800], lambda _: 1.0))) == []
    assert finer(points(made([MOST_STEPS // 2, MOST_STEPS]))) == []
