"""Figures: a panel an engine, colours that are told apart, loops that keep their shape."""

import itertools
import math
import re
from collections.abc import Callable

import numpy as np
import pytest
from matplotlib.figure import Figure

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.data.report import Report
from multibody_xval.reports.figures.drawing import Drawing, mathtext
from multibody_xval.reports.figures.stick_slip import CORNER, MODE_COLOURS, corners, phases
from multibody_xval.reports.figures.style import GREY, PALETTE, by_panel
from multibody_xval.reports.figures.transmittance import MOST_CURVES, _curves
from multibody_xval.reports.page.render import sections
from multibody_xval.reports.page.sections import StickSlip
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.sweeps.compared import ComparedSweep
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE

RGB = tuple[float, float, float]

# Machado, Oliveira and Fernandes (2009), severity 1.0, on linear RGB
PROTANOPIA = [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]
DEUTERANOPIA = [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]
TRITANOPIA = [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]]


def linear(colour: str) -> np.ndarray:
    value = np.array([int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)])
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


def lightness(colour: np.ndarray) -> float:
    """L* of CIELAB: 0 black, 100 white."""
    luminance = float(np.clip(colour, 0, 1) @ [0.2126, 0.7152, 0.0722])
    return 116 * luminance ** (1 / 3) - 16 if luminance > 0.008856 else 903.3 * luminance


@pytest.fixture(scope="module")
def drawings(report: Report) -> dict[str, Drawing]:
    return {drawing.name: drawing for section in sections(report) for drawing in section.figures()}


def test_every_engine_has_a_panel_with_the_reference_in_grey(drawings: dict[str, Drawing]) -> None:
    upper, lower = drawings["transmittance-0.3"].canvas.axes
    assert upper.get_title(loc="left") == "MuJoCo"
    names = {line.get_label(): line for line in upper.get_lines()}
    assert names[REFERENCE.title].get_color() == GREY["color"]
    assert np.isfinite(names["tuned"].get_ydata()).sum() == 3, "one of four points has no steady state"
    assert {line.get_label() for line in lower.get_lines()} >= {"tuned"}


def test_many_curves_are_drawn_apart() -> None:
    curves = {str(k): (np.arange(3.0), np.full(3, float(k))) for k in range(MOST_CURVES + 1)}
    panels = _curves("name", "", curves, "", 0.0, {}).canvas.axes
    assert [axes.get_title(loc="left") for axes in panels] == list(curves)
    few = dict(list(curves.items())[:MOST_CURVES])
    assert len(_curves("name", "", few, "", 0.0, {}).canvas.axes) == 1


def test_presets_without_a_title_have_a_panel_of_their_own() -> None:
    names = ("mujoco", "mujoco:joint:default", "mujoco:contact:newton", "mujoco:contact", "pybullet")
    panels = by_panel([Variant.parse(name) for name in names])
    assert {title: len(own) for title, own in panels.items()} == {
        "MuJoCo": 2, "MuJoCo, contact, newton": 1, "MuJoCo, contact": 1, "PyBullet": 1,
    }  # fmt: skip


def test_a_file_is_the_same_whenever_it_is_drawn_and_keeps_small_numbers() -> None:
    canvas = Figure()
    canvas.text(0.123456, 0.5, "0.00012345")
    drawing = Drawing("name", "", canvas)
    assert all(drawing.file(ending) == drawing.file(ending) for ending in ("svg", "pdf", "png"))
    assert b">0.00012345<" in drawing.file("svg")
    assert not re.search(rb'="[^"]*\d\.\d{3}', drawing.file("svg"))


def test_symbols_with_an_index_are_set_as_mathematics() -> None:
    assert mathtext("frequency ratio η_r = ω/ω_r [-]") == "frequency ratio $η_r$ = $ω/ω_r$ [-]"
    assert mathtext("friction ratio μλ\u0303_N [-]") == r"friction ratio $μ\tilde{λ}_N$ [-]"


@pytest.mark.parametrize("deficiency", [PROTANOPIA, DEUTERANOPIA, TRITANOPIA])
def test_stick_and_slip_are_told_apart_by_colour_blind_readers_and_in_grey(deficiency: list[list[float]]) -> None:
    for seen in (np.array(deficiency), np.eye(3)):
        levels = sorted(lightness(seen @ linear(colour)) for colour in MODE_COLOURS.values())
        assert min(b - a for a, b in itertools.pairwise(levels)) > 25


@pytest.mark.parametrize("deficiency", [PROTANOPIA, DEUTERANOPIA])
def test_colours_of_neighbours_differ_for_the_commonest_deficiencies(deficiency: list[list[float]]) -> None:
    seen = [np.array(deficiency) @ linear(colour) for colour in PALETTE]
    assert min(float(np.linalg.norm(a - b)) for a, b in itertools.pairwise(seen)) > 0.15


def test_phases_of_a_contact_fill_the_period_once() -> None:
    answer = Result(
        status="converged", period=2.0, stuck_fraction=(0.5, 1.0, 0.0),
        transitions=((1, 0.5, "forward slip"), (1, 1.5, "stick")),
    )  # fmt: skip
    found = phases(answer)
    assert [(p.cell, p.start, p.length, str(p.mode)) for p in found] == [
        (1, 0.0, 0.25, "stick"),
        (1, 0.25, 0.5, "forward slip"),
        (1, 0.75, 0.25, "stick"),
        (2, 0.0, 1.0, "stick"),
    ]


def test_a_raster_has_the_reference_and_every_engine_with_a_steady_state(result: ComparedSweep) -> None:
    figures = StickSlip(Report(result, "")).figures()
    assert [figure.name for figure in figures] == ["stick-slip-0.3-0.6", "stick-slip-0.3-0.9"]
    assert [axes.get_title(loc="left") for axes in figures[0].canvas.axes] == ["MuJoCo"]


@pytest.mark.parametrize("curve", [lambda t: (np.cos(t), np.sin(t)), lambda t: (np.sign(np.cos(t)), np.sin(3 * t))])
def test_points_that_a_curve_does_not_need_lie_on_its_lines(
    curve: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]],
) -> None:
    x, y = curve(np.linspace(0, 2 * math.pi, 400))
    kept = corners(x, y)
    assert 4 < len(kept) < 200
    assert (kept[0], kept[-1]) == (0, 399)
    along = np.arange(400)
    for first, last in itertools.pairwise(kept):
        line = np.array([x[last] - x[first], y[last] - y[first]]) / [np.ptp(x), np.ptp(y)]
        offset = np.array([x - x[first], y - y[first]]).T / [np.ptp(x), np.ptp(y)]
        inside = (along > first) & (along < last)
        length = np.hypot(*line)
        distance = np.abs(line[0] * offset[:, 1] - line[1] * offset[:, 0]) / length if length else np.hypot(*offset.T)
        assert np.all(distance[inside] <= CORNER + 1e-12)


def test_a_loop_of_exact_friction_is_four_corners() -> None:
    """To and fro with constant friction, and sticking at the ends."""
    slip, stick = np.linspace(-1, 1, 100), np.ones(100)
    x = np.concatenate([slip, stick, -slip, -stick])
    y = np.concatenate([-stick, slip, stick, -slip])
    assert len(corners(x, y)) == 5
