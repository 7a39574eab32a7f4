"""The chart of error over the time of a simulated second: its points are those of the table."""

import math
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.lines import Line2D

from engines.interface.variant import Variant
from reports.figures.errors import curves, speed_figure
from scenarios.studies.work_precision import PRINTED_COLUMNS, StepPoint
from scenarios.tables import full_table
from scenarios.verdicts.steady_case import CONVERGED, REFERENCE

OFF = Variant("mujoco", "joint", "default")
POINTS = [
    StepPoint(variant, steps, error / steps, cost, math.nan, 6, 6, "")
    for variant, error, cost in ((CONVERGED, 0.08, 1e-6), (REFERENCE, 2.8, 8e-8), (OFF, 400.0, 7e-6))
    for steps in (50, 400)
]


def lines(points: list[StepPoint], balance_db: float = 0.04) -> list[Line2D]:
    (axes,) = speed_figure(curves(points), balance_db).canvas.axes
    return axes.get_lines()


def test_points_of_the_chart_are_those_of_the_table() -> None:
    table = full_table(PRINTED_COLUMNS[2:4], POINTS)
    shown = lines(POINTS)[1:]
    assert [own.get_label() for own in shown] == [CONVERGED.title, REFERENCE.title, "as installed"]
    assert np.concatenate([own.get_ydata() for own in shown]).tolist() == list(table.iloc[:, 0])
    assert np.concatenate([own.get_xdata() for own in shown]).tolist() == list(table.iloc[:, 1])


def test_a_point_without_all_six_steady_states_is_not_drawn() -> None:
    fewer = [replace(own, certified=5) if own.variant == OFF else own for own in POINTS]
    assert "as installed" not in [own.get_label() for own in lines(fewer)]


@pytest.mark.parametrize("balance_db", [0.04, math.nan])
def test_harmonic_balance_has_an_error_and_no_time_of_its_own(balance_db: float) -> None:
    """Its line runs over all times; there is none where it fails."""
    drawn = [own for own in lines(POINTS, balance_db) if "harmonic" in str(own.get_label())]
    times = [1e3 * own.simulated_second for own in POINTS]
    assert [list(own.get_xdata()) for own in drawn] == [[min(times), max(times)]] * (not math.isnan(balance_db))
    assert all(list(own.get_ydata()) == [balance_db, balance_db] for own in drawn)
