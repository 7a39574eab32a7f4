"""The accuracy map: each number finds the error that it is there for, and no other."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from multibody_xval.scenarios.model import Config, Result, Run, Status, failed
from multibody_xval.scenarios.result_tables import points
from multibody_xval.scenarios.ruler.judge import judged
from multibody_xval.scenarios.ruler.proven import proven
from multibody_xval.scenarios.store import Stored
from multibody_xval.scenarios.studies.accuracy_map import (
    MAP,
    accuracies,
    map_runs,
    remarks,
)

CONFIG = Config("mujoco")


def made(change: Callable[[Run, Result], Result] = lambda _, own: own) -> pd.DataFrame:
    """Judge a configuration that gives the exact values, but for a change."""
    runs = [run for run in map_runs([CONFIG]) if run.config == CONFIG]
    exact = [Result(status=Status.PERIODIC, transmittance=proven()[run.case], stick_velocity=0.0) for run in runs]
    stored = [Stored(run, "1", change(run, own)) for run, own in zip(runs, exact, strict=True)]
    return accuracies(judged(points(stored)))


def scaled(factor: Callable[[Run], float]) -> Callable[[Run, Result], Result]:
    return lambda run, own: replace(own, transmittance=own.transmittance * factor(run))


def test_the_exact_motion_has_no_error() -> None:
    (row,) = made().itertuples()
    assert (row.map_db, row.map_percent, row.six_400_db, row.stick_velocity) == pytest.approx((0, 0, 0, 0), abs=1e-9)
    assert row.periodic == row.points
    assert np.isnan(row.order)


def test_an_error_is_that_of_the_amplitude_in_decibels_and_of_the_complex_distance_in_per_cent() -> None:
    level = 10 ** (-0.25 / 20)
    (row,) = made(scaled(lambda run: level if run.case == MAP[16] else 1.0)).itertuples()
    assert row.map_db == pytest.approx(0.25)
    assert row.map_percent == pytest.approx(100 * (1 - level))
    assert row.map_median_db == pytest.approx(0, abs=1e-9)
    assert row.worst == MAP[16]
    (turned,) = made(lambda _, own: replace(own, transmittance=own.transmittance * np.exp(0.01j))).itertuples()
    assert turned.map_db == pytest.approx(0, abs=1e-9)
    assert turned.map_percent == pytest.approx(1, rel=1e-2)


@pytest.mark.parametrize("order", [0, 1, 2])
def test_the_order_is_that_of_the_error_in_the_time_step(order: int) -> None:
    (row,) = made(scaled(lambda run: 10 ** (50 / run.steps**order / 20 / 100))).itertuples()
    assert row.order == pytest.approx(order, abs=1e-6)


def test_points_that_are_not_periodic_are_counted_and_give_no_numbers() -> None:
    table = made(lambda run, own: failed("crashed") if run.case.frequency_ratio == 0.9 else own)
    (row,) = table.itertuples()
    gone = 4 + 3 * 2  # on the map, and three of the six points with two more numbers of steps
    assert row.points - row.periodic == gone
    assert np.isnan(row.order)
    assert remarks(table)[0].endswith(f"{gone} of 68 points are not periodic; first failure: crashed")
