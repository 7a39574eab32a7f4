"""Curves of a dataset as a figure for print."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from multibody_xval import ParameterError, plot, sweep

pytestmark = pytest.mark.usefixtures("here")


@pytest.fixture(scope="module")
def data(here) -> xr.Dataset:
    return sweep(["reference", "mujoco"], [0.3, 0.1], (0.4, 1.5, 6), chain={"cells": 2})


def test_figure_has_a_panel_a_case_and_a_curve_a_configuration(data: xr.Dataset, tmp_path: Path) -> None:
    figure = plot(data, tmp_path / "figure.pdf")
    assert [axes.get_title() for axes in figure.axes] == ["friction ratio 0.3", "friction ratio 0.1"]
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["Reference (LCP)", "MuJoCo"]
    for axes in figure.axes:
        friction = float(axes.get_title().split()[-1])
        for line, name in zip(axes.get_lines()[1:], ("reference", "mujoco"), strict=True):
            own = data.transmittance_db.sel(configuration=name, friction_ratio=friction)
            np.testing.assert_array_equal(line.get_xdata(), data.frequency_ratio)
            np.testing.assert_array_equal(line.get_ydata(), own)
    assert b"/CIDFontType2" in (tmp_path / "figure.pdf").read_bytes(), "letters are no text"


def test_a_point_without_a_steady_state_is_a_gap_and_its_neighbours_are_seen(data: xr.Dataset) -> None:
    there = data.frequency_ratio == data.frequency_ratio[2]
    gap = data.assign(status=xr.where(there, "not periodic", data.status))
    line = plot(gap).axes[0].get_lines()[1]
    assert np.isnan(line.get_ydata()[2])
    assert np.isfinite(np.delete(line.get_ydata(), 2)).all()
    assert line.get_marker() == "."
    assert not plot(data).axes[0].get_lines()[1].get_marker()


@pytest.mark.parametrize(
    ("name", "cases", "message"),
    [
        ("missing/figure.pdf", 1, "the folder .*missing does not exist"),
        ("figure.gif", 1, "the ending '.gif'; allowed: .pdf, .svg, "),
        ("figure.pdf", 13, "26 cases; allowed: 1 to 24, such as"),
    ],
)
def test_a_figure_that_cannot_be_drawn_is_refused_before_it_is_written(data, tmp_path, name, cases, message) -> None:
    many = [data.assign_coords(friction_ratio=data.friction_ratio + k) for k in range(cases)]
    with pytest.raises(ParameterError, match=message):
        plot(xr.concat(many, "friction_ratio"), tmp_path / name)
    assert not list(tmp_path.iterdir())
