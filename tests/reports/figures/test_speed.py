"""The chart of error over the time of a simulated second: its points are those of the table."""

import math
from dataclasses import replace

import numpy as np
from matplotlib.lines import Line2D

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.figures.errors import curves, speed_figure
from multibody_xval.scenarios.studies.work_precision import PRINTED_COLUMNS, StepPoint
from multibody_xval.scenarios.tables import full_table
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED, REFERENCE

OFF = Variant("mujoco", "joint", "default")
POINTS = [
    StepPoint(variant, steps, error / steps, cost, math.nan, 6, 6, "")
    for variant, error, cost in ((CONVERGED, 0.08, 1e-6), (REFERENCE, 2.8, 8e-8), (OFF, 400.0, 7e-6))
    for steps in (50, 400)
]


def lines(points: list[StepPoint]) -> list[Line2D]:
    (axes,) = speed_figure(curves(points)).canvas.axes
    return axes.get_lines()


def test_points_of_the_chart_are_those_of_the_table() -> None:
    table = full_table(PRINTED_COLUMNS[2:4], POINTS)
    shown = lines(POINTS)
    assert [own.get_label() for own in shown] == [CONVERGED.title, REFERENCE.title, "as installed"]
    assert np.concatenate([own.get_ydata() for own in shown]).tolist() == list(table.iloc[:, 0])
    assert np.concatenate([own.get_xdata() for own in shown]).tolist() == list(table.iloc[:, 1])


def test_a_point_without_all_six_steady_states_is_not_drawn() -> None:
    fewer = [replace(own, certified=5) if own.variant == OFF else own for own in POINTS]
    assert "as installed" not in [own.get_label() for own in lines(fewer)]
