"""Figures: curves of a dataset for print, panels of the page, and motions."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from multibody_xval import (
    FrictionContact,
    MassSpringSystem,
    Motion,
    ParameterError,
    RickerPulse,
    Spring,
    plot,
    simulate,
    sweep,
)
from multibody_xval.reports.figures import levels
from multibody_xval.reports.figures.motion import plot_motion
from multibody_xval.reports.figures.svg import Panel
from multibody_xval.scenarios.model import Case
from reference_lcp import Chain, HarmonicBase, steady_state

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


def test_a_figure_of_too_many_cases_is_refused_before_it_is_written(data: xr.Dataset, tmp_path: Path) -> None:
    many = [data.assign_coords(friction_ratio=data.friction_ratio + k) for k in range(13)]
    with pytest.raises(ParameterError, match="26 cases; allowed: 1 to 24, such as"):
        plot(xr.concat(many, "friction_ratio"), tmp_path / "figure.pdf")
    assert not list(tmp_path.iterdir())


LEVELS = {0.5: 10.0, 0.7: -25.0, 0.9: -71.0}


def rows(engine: str, options: str, statuses: dict[float, str]) -> list[dict[str, Any]]:
    return [
        {"engine": engine, "preset": "tuned", "title": engine, "options": options, "place": "friction ratio 0.3",
         "steps": 400, "case": Case(friction_ratio=0.3, frequency_ratio=1.0), "frequency_ratio": eta, "status": status,
         "transmittance_db": LEVELS[eta] if status == "periodic" else float("nan"), "error_db": 0.5}
        for eta, status in statuses.items()
    ]  # fmt: skip


def table(options: dict[str, dict[float, str]]) -> pd.DataFrame:
    every = dict.fromkeys(LEVELS, "periodic")
    own = [row for name, statuses in options.items() for row in rows("mujoco", name, statuses)]
    return pd.DataFrame([*rows("reference", "reference", every), *own])


def drawn(options: dict[str, dict[float, str]]) -> tuple[Panel, Axes]:
    (panel,), axes = levels.transmittance(table(options)), Figure().subplots()
    panel.draw(axes)
    return panel, axes


def marks(axes: Axes) -> dict[float, str]:
    marked = [line for line in axes.get_lines() if line.get_marker() != "None"]
    return {float(x): str(line.get_marker()) for line in marked for x in line.get_xdata()}


def test_each_reason_for_no_level_has_a_mark_and_what_is_not_supported_has_none() -> None:
    panel, axes = drawn({"recipe": {0.5: "not periodic", 0.7: "failed", 0.9: "unsupported"}})
    assert marks(axes) == {0.5: "|", 0.7: "x"}
    assert panel.title == "mujoco: friction ratio 0.3 (not supported: 1 of 3 points, recipe)"
    assert panel.text == "recipe: 0 of 2 points periodic, 1 failed, 1 not supported."


def test_levels_are_drawn_where_they_are_and_one_far_below_the_others_is_a_triangle(monkeypatch) -> None:
    _, axes = drawn({"recipe": dict.fromkeys(LEVELS, "periodic")})
    reference, engine = axes.get_lines()
    assert list(reference.get_ydata()) == list(engine.get_ydata()) == list(LEVELS.values())
    assert axes.get_ylim() == (-89.0, 10.0), "the lowest ten, and a tenth of the axis below it"
    monkeypatch.setitem(LEVELS, 0.9, -250.0)
    _, axes = drawn({"recipe": dict.fromkeys(LEVELS, "periodic")})
    assert marks(axes) == {0.5: "s", 0.7: "s", 0.9: "v"}


def test_a_motion_and_a_steady_state_of_a_chain_and_of_bodies_are_drawn(tmp_path) -> None:
    chain = Chain.from_ratios(cells=2, friction_ratio=0.3)
    motion = simulate(chain, RickerPulse(0.01, 30.0, 0.4), time_step=1e-3, steps=900)
    figure = plot(motion, tmp_path / "pulse.svg")
    assert figure.axes[0].get_lines()[1].get_ydata() == pytest.approx(motion.inner_positions[:, 0])
    orbit = steady_state(chain, HarmonicBase.from_ratio(chain, 0.6), with_error_bar=False).orbit
    figure = plot_motion(orbit)
    assert len(figure.axes) == 3 * chain.cells
    scaled = orbit.trajectory.outer_positions[:, 0] / orbit.lane.drive.displacement_scale(chain)
    assert figure.axes[0].get_lines()[0].get_ydata() == pytest.approx(scaled)
    springs = [Spring(0, Motion(amplitude=1.0, angular_frequency=0.6), 1.0), Spring(1, 0, 1.0)]
    rubbing = [FrictionContact(1, None, 1.0, 0.3)]
    state = steady_state(MassSpringSystem(masses=[1.0, 1.0], springs=springs, friction=rubbing))
    lines = [axis.get_lines() for axis in plot(state).axes]
    assert [len(own) for own in lines] == [1, 1, 1, 1, 0, 0]
    assert lines[3][0].get_ydata() == pytest.approx(state.orbit.trajectory.positions[:, 1])
