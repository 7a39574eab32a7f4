"""Figures: what plotly is given is what it knows, colours and shapes are told apart, loops keep their shape."""

import itertools
import math
from collections.abc import Callable

import numpy as np
import plotly.graph_objects as go
import pytest

from engines.interface.variant import Variant
from reports.data.report import Report
from reports.drawing.figure import Axis, Figure, Panel, Rule, Series, difference_axis
from reports.drawing.matplotlib_backend import drawn, mathtext
from reports.drawing.plotly_backend import plot
from reports.drawing.style import PALETTE, Style, style_of
from reports.figures.stick_slip import CORNER, MODE_COLOURS, corners, phases
from reports.page.render import sections
from reports.page.sections import StickSlip
from scenarios.runs.result import Result
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.sweep import Sweep

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


@pytest.fixture
def many() -> Sweep:
    class Registered(Sweep):
        """Forty-eight variants, whether or not anybody has registered them."""

        def __post_init__(self) -> None:
            return

    return Registered(variants=tuple(Variant(f"engine{k}") for k in range(48)), axes={})


def test_plotly_knows_everything_that_it_is_given(report: Report) -> None:
    every = figures_of(report)
    assert len(every) > 8
    for figure in every:
        known = go.Figure(plot(figure))  # raises at the first unknown name or wrong value
        assert known.data, figure.name


def figures_of(report: Report) -> list[Figure]:
    return [figure for part in sections(report) for figure in part.figures()]


def test_print_and_page_have_the_same_points_names_and_labels(report: Report) -> None:
    for figure in figures_of(report):
        canvas, traces = drawn(figure), plot(figure)["data"]
        lines = [series.lines[0] for axes in canvas.axes for series in axes.containers]
        joined = [trace for trace in traces if trace["type"] == "scatter"]
        assert [len(line.get_xdata()) for line in lines] == [len(trace["x"]) for trace in joined], figure.name
        if figure.legend_columns:
            told = {text.get_text() for text in canvas.legends[0].get_texts()}
            assert told == {trace["name"] for trace in traces if trace["showlegend"]}, figure.name
        printed = {axes.get_xlabel() for axes in canvas.axes} - {""}
        assert printed == {mathtext(panel.x.label) for panel in figure.panels} - {""}, figure.name


def test_what_panels_share_stands_at_the_first_of_a_row_and_below_the_last_of_a_column() -> None:
    panels = [Panel(Axis("x"), Axis("y"), [Series([0, 1], [k, k], Style("black"), str(k))]) for k in range(4)]
    layout = plot(Figure("four", "", panels, 3.0, 300, columns=2, x_label="below", y_label="left"))["layout"]
    names = ["xaxis", "xaxis2", "xaxis3", "xaxis4"]
    assert ["below" in layout[name]["title"]["text"] for name in names] == [False, False, True, True]
    assert ["left" in layout[name.replace("x", "y", 1)]["title"]["text"] for name in names] == [
        True,
        False,
        True,
        False,
    ]


def test_differences_are_drawn_at_their_logarithm_and_told_as_they_are() -> None:
    panel = Panel(
        Axis("place", ticks={0.0: "left", 1.0: "right"}), difference_axis("difference", 0.01, [0.02, 0.5], 1.0),
        [Series([0.0, 1.0, 2.0], [0.01, -1.0, math.nan], Style("#000000"), "one", hover="%{y:+.3f}"),
         Rule("y", 0.02, Style("#000000"))],
    )  # fmt: skip
    given = plot(Figure("name", "caption", [panel], 2.0, 300))
    (trace,), layout = given["data"], given["layout"]
    assert trace["y"] == [pytest.approx(math.asinh(1.0), abs=1e-5), pytest.approx(-math.asinh(100.0), abs=1e-5), None]
    assert trace["customdata"] == [0.01, -1.0, None]
    assert trace["hovertemplate"] == "%{customdata:+.3f}"
    assert layout["shapes"][0]["y0"] == pytest.approx(math.asinh(2.0))
    assert layout["yaxis"]["ticktext"] == ["−0.5", "−0.02", "0", "0.02", "0.5"]
    assert layout["yaxis"]["range"] == pytest.approx([-math.asinh(100.0), math.asinh(100.0)])
    assert layout["xaxis"]["ticktext"] == ["left", "right"]


def test_error_bars_end_where_their_values_are_on_a_stretched_axis() -> None:
    series = Series([0.1], [0.0], Style("#000000"), draw="markers", x_error=[0.05])
    given = plot(Figure("name", "", [Panel(difference_axis("", 0.01, [], 1.0), Axis(), [series])], 2.0, 300))
    (trace,) = given["data"]
    (x,), bars = trace["x"], trace["error_x"]
    assert x + bars["array"][0] == pytest.approx(math.asinh(15.0), abs=2e-5)
    assert x - bars["arrayminus"][0] == pytest.approx(math.asinh(5.0), abs=2e-5)


def test_symbols_with_an_index_are_set_as_mathematics() -> None:
    assert mathtext("frequency ratio η_r = ω/ω_r [-]") == "frequency ratio $η_r$ = $ω/ω_r$ [-]"
    assert mathtext("friction ratio μλ\u0303_N [-]") == r"friction ratio $μ\tilde{λ}_N$ [-]"


def test_every_variant_of_forty_eight_has_a_style_of_its_own(many: Sweep) -> None:
    styles = [style_of(many, variant) for variant in many.variants]
    assert len({(style.colour, style.symbol) for style in styles}) == 48


def test_neighbours_are_told_apart_without_colour(many: Sweep) -> None:
    styles = [style_of(many, variant) for variant in many.variants]
    assert all(a.symbol != b.symbol and a.dash != b.dash for a, b in itertools.pairwise(styles))


@pytest.mark.parametrize("deficiency", [PROTANOPIA, DEUTERANOPIA, TRITANOPIA])
def test_stick_and_slip_are_told_apart_by_colour_blind_readers_and_in_grey(deficiency: list[list[float]]) -> None:
    for seen in (np.array(deficiency), np.eye(3)):
        levels = sorted(lightness(seen @ linear(colour)) for colour in MODE_COLOURS.values())
        assert min(b - a for a, b in itertools.pairwise(levels)) > 25


@pytest.mark.parametrize("deficiency", [PROTANOPIA, DEUTERANOPIA])
def test_colours_of_neighbours_differ_for_the_commonest_deficiencies(deficiency: list[list[float]]) -> None:
    seen = [np.array(deficiency) @ linear(colour) for colour in PALETTE]
    assert min(float(np.linalg.norm(a - b)) for a, b in itertools.pairwise(seen)) > 0.15


def test_series_have_the_same_colour_in_print_and_on_the_screen(many: Sweep) -> None:
    series = Series([0.0, 1.0], [0.0, 1.0], style_of(many, many.variants[7]), "seven", "lines+markers")
    figure = Figure("name", "caption", [Panel(Axis(), Axis(), [series])], 2.0, 300)
    (trace,), (line,) = plot(figure)["data"], drawn(figure).axes[0].lines
    assert line.get_color() == trace["marker"]["color"] == trace["line"]["color"]


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
    assert "Reference (LCP); MuJoCo" in figures[0].caption
    assert "PyBullet" not in figures[0].caption


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
