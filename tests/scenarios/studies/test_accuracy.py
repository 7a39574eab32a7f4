"""Accuracy and what it costs: each number of the tables finds the error that it is there for."""

from collections.abc import Callable, Sequence

import numpy as np
import pandas as pd
import pytest

from multibody_xval.scenarios.model import REFERENCE, Config, Result, Run, Status
from multibody_xval.scenarios.result_tables import now, points
from multibody_xval.scenarios.ruler.judge import judged
from multibody_xval.scenarios.ruler.proven import proven
from multibody_xval.scenarios.studies import accuracy_map
from multibody_xval.scenarios.studies import laws as study
from multibody_xval.scenarios.studies.step_study import MOST_STEPS, TIMED, finer, remarks, step_runs, step_table

TUNED, DEFAULT = Config("mujoco"), Config("mujoco", preset_name="default")


def accuracy(factor: Callable[[Run], complex] = lambda _: 1.0) -> pd.Series:
    """Give the row of a configuration whose transmittances are the exact ones, but for a factor."""
    runs = [run for run in accuracy_map.map_runs([TUNED]) if run.config == TUNED]
    results = {run: Result(status=Status.PERIODIC, transmittance=proven()[run.case] * factor(run), stick_velocity=0.0)
               for run in runs}  # fmt: skip
    (row,) = accuracy_map.accuracies(judged(points(now(results)))).iloc
    return row


def test_an_error_is_that_of_the_amplitude_in_decibels_and_of_the_complex_distance_in_per_cent() -> None:
    row = accuracy()
    assert (row.map_db, row.map_percent, row.six_400_db, row.stick_velocity) == pytest.approx((0, 0, 0, 0), abs=1e-9)
    assert row.periodic == row.points
    assert np.isnan(row.order)
    level = 10 ** (-0.25 / 20)
    row = accuracy(lambda run: level if run.case == accuracy_map.MAP[16] else 1.0)
    assert (row.map_db, row.map_percent) == pytest.approx((0.25, 100 * (1 - level)))
    assert row.map_median_db == pytest.approx(0, abs=1e-9)
    assert row.worst == accuracy_map.MAP[16]
    row = accuracy(lambda _: np.exp(0.01j))
    assert row.map_db == pytest.approx(0, abs=1e-9)
    assert row.map_percent == pytest.approx(1, rel=1e-2)


@pytest.mark.parametrize("order", [0, 1, 2])
def test_the_order_is_that_of_the_error_in_the_time_step(order: int) -> None:
    assert accuracy(lambda run: 10 ** (50 / run.steps**order / 20 / 100)).order == pytest.approx(order, abs=1e-6)


A_STEP, PERIODS = 3e-6, 20
"""Seconds a step, and periods of a search."""


def stepped(steps: Sequence[int], error_db: Callable[[int], float] = lambda steps: 4 / steps) -> pd.DataFrame:
    """Give points that are off by an error, and take some time a step."""
    asked = [run for run in step_runs([DEFAULT], steps) if run.config == DEFAULT and run.steps in steps]
    results = {
        run: Result(
            status=Status.PERIODIC, transmittance=proven()[run.case] * 10 ** (error_db(run.steps) / 20),
            periods=PERIODS, seconds=A_STEP * PERIODS * run.steps,
        )
        for run in asked
    }  # fmt: skip
    return points(now(results))


def test_error_and_cost_are_read_from_results_by_ascending_steps() -> None:
    own, steps = step_table(judged(stepped([800, 100, 400]))), np.array([100, 400, 800])
    assert own.steps.tolist() == steps.tolist()
    assert own.error_db.tolist() == pytest.approx(4 / steps)
    assert own.step_seconds.tolist() == pytest.approx([A_STEP] * 3)
    assert own.seconds.tolist() == pytest.approx(A_STEP * PERIODS * steps)
    assert own.milliseconds[1] == pytest.approx(1e3 * A_STEP / TIMED.lane(400).time_step)
    assert own["product"][1] == pytest.approx(own.error_db[1] * own.milliseconds[1])


def test_steps_are_doubled_only_where_the_error_falls_and_no_farther_than_the_most() -> None:
    for error_db, count in ((0.89, 0), (0.91, 1)):
        table = step_table(judged(stepped([50, 400], {50: 1.0, 400: error_db**3}.__getitem__)))
        assert len(remarks(table)) == count, "it has to fall at every doubling"
    assert {(run.steps, run.config) for run in finer(stepped([400, 800]))} == {(1600, DEFAULT)}
    assert finer(stepped([400, 800], lambda _: 1.0)) == finer(stepped([MOST_STEPS // 2, MOST_STEPS])) == []


def test_soft_friction_of_a_joint_is_what_its_law_says_and_far_from_coulombs() -> None:
    table = study.law_distances([REFERENCE, TUNED, DEFAULT, Config("mujoco", "contact", "default")])
    assert table.steps_by.tolist() == ["the reference's scheme", "a law"], "a preset without a law has a row"
    assert (table.largest <= table.allowed).all()
    assert table.from_reference[1] > 1e3 * table.allowed[1]
    (line,) = study.formulas(table)
    assert line.startswith("mujoco:joint:default: forces at the start of the step")
    assert "d_max = 0.95" in line
