"""Accuracy and what it costs: each number of the tables finds the error that it is there for."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.model import REFERENCE, Config, Result, Run, Status
from multibody_xval.scenarios.result_tables import points
from multibody_xval.scenarios.ruler.judge import judged
from multibody_xval.scenarios.ruler.proven import proven
from multibody_xval.scenarios.store import Stored
from multibody_xval.scenarios.studies import accuracy_map
from multibody_xval.scenarios.studies import laws as study
from multibody_xval.scenarios.studies.step_study import MOST_STEPS, TIMED, finer, step_runs, step_table
from multibody_xval.scenarios.studies.step_study import remarks as step_remarks

CONFIG = Config("mujoco")


def made(change: Callable[[Run, Result], Result] = lambda _, own: own) -> pd.DataFrame:
    """Judge a configuration that gives the exact values, but for a change."""
    runs = [run for run in accuracy_map.map_runs([CONFIG]) if run.config == CONFIG]
    exact = [Result(status=Status.PERIODIC, transmittance=proven()[run.case], stick_velocity=0.0) for run in runs]
    stored = [Stored(run, "1", change(run, own)) for run, own in zip(runs, exact, strict=True)]
    return accuracy_map.accuracies(judged(points(stored)))


def scaled(factor: Callable[[Run], float]) -> Callable[[Run, Result], Result]:
    return lambda run, own: replace(own, transmittance=own.transmittance * factor(run))


def test_the_exact_motion_has_no_error() -> None:
    (row,) = made().itertuples()
    assert (row.map_db, row.map_percent, row.six_400_db, row.stick_velocity) == pytest.approx((0, 0, 0, 0), abs=1e-9)
    assert row.periodic == row.points
    assert np.isnan(row.order)


def test_an_error_is_that_of_the_amplitude_in_decibels_and_of_the_complex_distance_in_per_cent() -> None:
    level = 10 ** (-0.25 / 20)
    (row,) = made(scaled(lambda run: level if run.case == accuracy_map.MAP[16] else 1.0)).itertuples()
    assert row.map_db == pytest.approx(0.25)
    assert row.map_percent == pytest.approx(100 * (1 - level))
    assert row.map_median_db == pytest.approx(0, abs=1e-9)
    assert row.worst == accuracy_map.MAP[16]
    (turned,) = made(lambda _, own: replace(own, transmittance=own.transmittance * np.exp(0.01j))).itertuples()
    assert turned.map_db == pytest.approx(0, abs=1e-9)
    assert turned.map_percent == pytest.approx(1, rel=1e-2)


@pytest.mark.parametrize("order", [0, 1, 2])
def test_the_order_is_that_of_the_error_in_the_time_step(order: int) -> None:
    (row,) = made(scaled(lambda run: 10 ** (50 / run.steps**order / 20 / 100))).itertuples()
    assert row.order == pytest.approx(order, abs=1e-6)


ENGINE = Config("mujoco", preset_name="default")
A_STEP, PERIODS = 3e-6, 20


def stepped(
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
    own = table(stepped([800, 100, 400]))
    assert own.steps.tolist() == [100, 400, 800]
    assert own.error_db.tolist() == pytest.approx([4 / 100, 4 / 400, 4 / 800])
    assert own.step_seconds.tolist() == pytest.approx([A_STEP] * 3)
    assert own.seconds.tolist() == pytest.approx([A_STEP * PERIODS * steps for steps in (100, 400, 800)])
    length = TIMED.lane(400).time_step
    assert own.milliseconds[1] == pytest.approx(1e3 * A_STEP / length)
    assert own["product"][1] == pytest.approx(own.error_db[1] * own.milliseconds[1])


@pytest.mark.parametrize(("error_db", "count"), [(0.89, 0), (0.91, 1)])
def test_an_error_has_to_fall_at_every_doubling_of_the_steps(error_db: float, count: int) -> None:
    assert len(step_remarks(table(stepped([50, 400], {50: 1.0, 400: error_db**3}.__getitem__)))) == count


def test_steps_are_doubled_only_where_the_error_still_falls_and_no_farther_than_the_most() -> None:
    falls = finer(points(stepped([400, 800])))
    assert ({run.steps for run in falls}, {run.config for run in falls}) == ({1600}, {ENGINE})
    assert finer(points(stepped([400, 800], lambda _: 1.0))) == []
    assert finer(points(stepped([MOST_STEPS // 2, MOST_STEPS]))) == []


SOFT = Variant("mujoco", "joint", "default")


def test_soft_friction_of_a_joint_is_what_its_law_says_and_far_from_coulombs() -> None:
    table = study.law_distances([REFERENCE, Variant("mujoco"), SOFT, Variant("mujoco", "contact", "default")])
    assert table.steps_by.tolist() == ["the reference's scheme", "a law"], "a preset without a law has a row"
    assert (table.largest <= table.allowed).all()
    assert table.from_reference[1] > 1e3 * table.allowed[1]
    (line,) = study.formulas(table)
    assert line.startswith("mujoco:joint:default: forces at the start of the step")
    assert "d_max = 0.95" in line
