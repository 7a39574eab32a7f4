"""Error maps: every point of the grid at its place, blank where nothing can be compared, colours common to all."""

import math
from dataclasses import replace

import numpy as np
import pytest

from multibody_xval.reports.data.points import point_table
from multibody_xval.reports.data.report import Report
from multibody_xval.reports.figures.errors import HIGHEST_DB, LOWEST_DB, error_map_figure, error_maps, unsteady
from multibody_xval.reports.page.sections import ErrorMaps
from multibody_xval.scenarios.sweeps.compared import ComparedSweep
from multibody_xval.scenarios.sweeps.sweep import Case
from multibody_xval.scenarios.verdicts.finding import FLOOR_DB
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE
from tests.reports.conftest import CONVERGED_ERROR, GRID, OFF, RUNS, STEP_ERROR

ERROR = STEP_ERROR + CONVERGED_ERROR
"""Of the scheme's step to the truth [dB]."""


def test_a_variant_is_off_where_it_is_wrong_and_by_the_step_elsewhere(report: Report) -> None:
    maps = error_maps(report.points, report.result.cases, report.errors)
    assert list(maps) == [REFERENCE, RUNS], "neither the converged reference nor what is not installed"
    assert maps[REFERENCE].to_numpy() == pytest.approx(np.full((2, 4), ERROR), abs=1e-9)
    expected = np.full((2, 4), ERROR)
    expected[0, GRID.index(OFF[2])] += 0.03
    expected[1, 3] = math.nan
    assert maps[RUNS].to_numpy() == pytest.approx(expected, abs=1e-9, nan_ok=True)
    lost = unsteady(report.points)
    lost = lost[lost["variant"].isin([REFERENCE, RUNS])]
    assert lost[["variant", "case", "frequency_ratio"]].to_numpy().tolist() == [[RUNS, report.result.cases[1], 1.3]]


def test_a_case_with_fewer_frequencies_shows_the_nearest_of_its_own(report: Report) -> None:
    """Where one curve is resolved more finely than the others."""
    coarse = Case.of(friction_ratio=0.3)
    points = [p for p in report.result.points if p.case != coarse or p.frequency_ratio in (0.3, 0.9)]
    result = replace(report.result, points=points, edges=())
    own = error_maps(replace(report, result=result, headline=()).points, result.cases, [RUNS])[RUNS]
    wrong = result.curve(RUNS, Case.of(friction_ratio=0.0))[2]
    assert own.columns.tolist() == list(GRID)
    assert own.iloc[0, 2] == pytest.approx(ERROR + 0.03)
    assert wrong.frequency_ratio == 0.9
    assert np.isfinite(own.to_numpy()).all()


@pytest.mark.parametrize("level", [-100.0, FLOOR_DB])
def test_where_the_truth_is_too_small_a_map_is_blank_and_complains_of_nothing(report: Report, level: float) -> None:
    points = [
        replace(point, truth=replace(point.truth, transmittance_db=level)) if point.frequency_ratio == 1.3 else point
        for point in report.result.points
    ]
    table = point_table(replace(report.result, points=points))
    own = error_maps(table, report.result.cases, [RUNS])[RUNS]
    assert np.isnan(own[1.3]).all()
    assert np.isfinite(own.drop(columns=1.3).to_numpy()).all()
    assert RUNS not in set(unsteady(table)["variant"])


def test_colours_are_of_the_logarithm_and_common_to_all_maps_with_one_scale(report: Report) -> None:
    figure = error_map_figure(
        error_maps(report.points, report.result.cases, report.errors), unsteady(report.points), "friction ratio"
    )
    meshes = [axes.collections[0] for axes in figure.canvas.axes[:2]]
    assert {(mesh.norm.vmin, mesh.norm.vmax) for mesh in meshes} == {(LOWEST_DB, HIGHEST_DB)}
    values = np.ma.filled(meshes[1].get_array(), math.nan)
    assert values[0, 2] == pytest.approx(ERROR + 0.03)
    assert math.isnan(values[1, 3])
    assert len(figure.canvas.axes) == 3, "one scale of colours"


def test_a_sweep_of_one_curve_has_no_map(result: ComparedSweep, report: Report) -> None:
    sweep = replace(result.sweep, axes={**result.sweep.axes, "friction_ratio": (0.3,)})
    points = [point for point in result.points if point.case.friction_ratio == 0.3]
    single = replace(report, result=ComparedSweep(sweep, points), headline=())
    assert ErrorMaps(report).shown
    assert not ErrorMaps(single).shown
