"""What is asked of a dataset: band edges as a table, curves as a figure that can be printed."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from multibody_xval import ParameterError, band_edges, plot, report, sweep
from multibody_xval.reports.data.stick_slip import stick_slip_places
from multibody_xval.scenarios.sweeps.compared import judged_points
from multibody_xval.scenarios.sweeps.dataset_reader import DatasetResults

FRICTIONS = [0.15, 0.25]
"""Those of no point at which every report compares modes."""

ETAS = (0.4, 1.5, 23)


pytestmark = pytest.mark.usefixtures("in_this_process")


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("edges") / "results.sqlite"


@pytest.fixture(scope="module")
def data(store: Path) -> xr.Dataset:
    return sweep(["reference", "mujoco"], FRICTIONS, ETAS, chain={"cells": 3}, store=store, workers=1)


@pytest.fixture(scope="module")
def edges(data: xr.Dataset, store: Path) -> pd.DataFrame:
    return band_edges(data, store=store, workers=1)


def test_transmittance_at_an_edge_is_that_of_the_base(edges: pd.DataFrame) -> None:
    lower = edges[(edges["edge"] == "lower") & (edges["engine"] == "mujoco")]
    assert len(lower) == 2
    eta = lower["frequency_ratio"].tolist()
    there = sweep("reference", FRICTIONS, eta, chain={"cells": 3}, workers=1).sel(variant="reference")
    levels = there.transmittance_db.sel(frequency_ratio=eta).values
    assert np.all(np.abs(np.diag(levels)) < 1e-3)
    assert np.all(np.abs(np.diag(levels[:, ::-1])) > 0.1), "the other curve crosses elsewhere"


@pytest.mark.slow
def test_report_of_the_store_has_the_edges_of_the_table(edges: pd.DataFrame, store: Path, tmp_path: Path) -> None:
    report(store, tmp_path / "report")
    written = pd.read_csv(tmp_path / "report" / "band_edges.csv")
    assert written["frequency_ratio"].tolist() == pytest.approx(edges["frequency_ratio"].tolist(), nan_ok=True)


@pytest.mark.slow
def test_report_of_a_dataset_says_how_to_get_its_edges(data: xr.Dataset, tmp_path: Path) -> None:
    text = report(data, tmp_path / "report").read_text()
    assert "<code>band_edges(data)</code>" in text
    assert "<h2>Stick and slip</h2>" in text


def test_another_version_of_an_engine_refines_no_edge(data: xr.Dataset) -> None:
    version = data["version"].sel(variant="mujoco").item()
    other = data.assign_attrs(variants=data.attrs["variants"].replace(f'"version": "{version}"', '"version": "1.0"'))
    with pytest.raises(ParameterError, match=r"of mujoco 1\.0, and .* is installed; allowed: the same version"):
        band_edges(other)


def test_stick_and_slip_is_shown_where_contacts_do_both(data: xr.Dataset) -> None:
    known = DatasetResults(data)
    result = judged_points(known.sweep, known.points, known, known.predictions, known.modelled)
    places = stick_slip_places(result)
    assert [case.friction_ratio for case, _ in places] == FRICTIONS
    for case, eta in places:
        stuck = data.stuck_fraction.sel(variant="reference", friction_ratio=case.friction_ratio, frequency_ratio=eta)
        assert 0 < stuck.mean() < 1


def test_figure_has_a_panel_a_case_and_a_curve_an_engine(data: xr.Dataset, tmp_path: Path) -> None:
    figure = plot(data, tmp_path / "figure.pdf")
    assert [axes.get_title() for axes in figure.axes] == ["friction ratio 0.15", "friction ratio 0.25"]
    assert [axes.get_ylabel() for axes in figure.axes] == ["transmittance [dB]", ""]
    low, high = figure.axes[0].get_ylim()
    assert low < data.transmittance_db.min()
    assert high > data.transmittance_db.max()
    text = (tmp_path / "figure.pdf").read_bytes()
    assert b"/CIDFontType2" in text
    assert b"/Type3" not in text


def test_curve_of_an_adaptive_grid_has_no_gap_where_only_another_curve_has_points() -> None:
    adaptive = {"first": 0.5, "last": 1.2, "accuracy_db": 3.0, "least_spacing": 0.01}
    data = sweep(["reference"], [0.0, 0.3], adaptive, chain={"cells": 1}, workers=1).sel(variant=["reference"])
    assert data.transmittance_db.isnull().any(), "without a gap in the table the test says nothing"
    for line in plot(data).axes[0].get_lines()[1:]:
        assert np.all(np.isfinite(line.get_ydata()))


def test_depths_below_what_is_drawn_do_not_stretch_the_axis(data: xr.Dataset) -> None:
    deep = data.assign(transmittance_db=data.transmittance_db - 300.0)
    assert plot(deep).axes[0].get_ylim()[0] == -80.0


@pytest.mark.parametrize("ask", [plot, band_edges])
def test_what_is_no_dataset_is_named(ask, tmp_path: Path) -> None:
    with pytest.raises(ParameterError, match="data is a DataFrame; allowed: the dataset of a sweep"):
        ask(pd.DataFrame())
    with pytest.raises(ParameterError, match="data is a DataFrame; allowed: the dataset of a sweep, or the path"):
        report(pd.DataFrame(), tmp_path)


def test_too_many_cases_for_one_figure_are_refused(data: xr.Dataset) -> None:
    many = xr.concat([data.assign_coords(friction_ratio=data.friction_ratio + k) for k in range(13)], "friction_ratio")
    with pytest.raises(ParameterError, match="26 cases; allowed: <= 24"):
        plot(many)


def test_a_figure_in_a_missing_folder_is_refused_before_it_is_drawn(data, tmp_path) -> None:
    with pytest.raises(ParameterError, match=r"the folder .*missing does not exist"):
        plot(data, tmp_path / "missing" / "figure.pdf")
