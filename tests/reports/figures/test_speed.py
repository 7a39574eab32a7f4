"""The chart of error over the time of a simulated second: its points are those of the table."""

import math
from dataclasses import replace

import numpy as np

from engines.interface.variant import Variant
from reports.drawing.figure import Figure, Series
from reports.figures.errors import curves, speed_figure
from scenarios.studies.figure3 import figure3
from scenarios.studies.work_precision import PRINTED_COLUMNS, StepPoint
from scenarios.tables import full_table
from scenarios.verdicts.steady_case import CONVERGED, REFERENCE

OFF = Variant("mujoco", "joint", "default")
SWEEP = figure3([OFF])
POINTS = [
    StepPoint(variant, steps, error / steps, cost, math.nan, 6, 6, "")
    for variant, error, cost in ((CONVERGED, 0.08, 1e-6), (REFERENCE, 2.8, 8e-8), (OFF, 400.0, 7e-6))
    for steps in (50, 400)
]


def figure(points: list[StepPoint]) -> Figure:
    return speed_figure(SWEEP, curves(points))


def series(chart: Figure) -> list[Series]:
    (panel,) = chart.panels
    return [mark for mark in panel.marks if isinstance(mark, Series)]


def test_points_of_the_chart_are_those_of_the_table() -> None:
    table = full_table(PRINTED_COLUMNS[2:4], POINTS)
    shown = series(figure(POINTS))
    assert [own.name for own in shown] == [variant.title for variant in (CONVERGED, REFERENCE, OFF)]
    assert np.concatenate([own.y for own in shown]).tolist() == list(table.iloc[:, 0])
    assert np.concatenate([own.x for own in shown]).tolist() == list(table.iloc[:, 1])


def test_a_point_without_all_six_steady_states_is_not_drawn() -> None:
    fewer = [replace(own, certified=5) if own.variant == OFF else own for own in POINTS]
    assert OFF.title not in [own.name for own in series(figure(fewer))]


def test_axes_are_logarithmic_with_units_and_the_truth_is_named() -> None:
    chart = figure(POINTS)
    (panel,) = chart.panels
    assert (panel.x.scale, panel.y.scale) == ("log", "log")
    assert "[ms]" in panel.x.label
    assert "[dB]" in panel.y.label
    assert "proven truth" in chart.legend_title
    assert "50 to 400 steps" in chart.legend_title
