"""Figure 3 of the paper, by the reference and by every engine with its differences; and over friction and frequency."""

import math

import numpy as np
import pandas as pd

from engines.interface.tolerances import CONVERGED_TOLERANCE_DB, SCHEME_TOLERANCE_DB
from engines.interface.variant import Variant
from reference_lcp.validation import FloatArray
from reports.data.descriptions import file_name, named_axes
from reports.data.report import Report
from reports.drawing.figure import Axis, Draw, Figure, HeatMap, Mark, Panel, Rule, Series, difference_axis
from reports.drawing.style import DASHED, DOTTED, RULE, SOLID, Style, compared_variants, curve_style, style_of
from reports.formatting import ratio
from scenarios.runs.result import ResultStatus
from scenarios.studies.friction_map import FrictionMap
from scenarios.studies.response import Curves
from scenarios.sweeps.sweep import Case, Sweep
from scenarios.verdicts.steady_case import CONVERGED, REFERENCE

FREQUENCY_LABEL = "frequency ratio η_r = ω/ω_r [-]"

FIGURE3 = "figure3"
"""Name of the figure of the reference's curves."""

LOWEST_DB = -80.0
"""Lowest transmittance that is drawn: beyond, the motion is less than the ten-thousandth part of the base's."""

LINEAR_DB = SCHEME_TOLERANCE_DB / 2
"""Differences below are drawn to scale, larger ones by their logarithm: the tightest tolerance is visible."""

DIFFERENCE_TICKS = (SCHEME_TOLERANCE_DB, CONVERGED_TOLERANCE_DB, 2.0, 10.0, 50.0)

MOST_VECTOR_MARKERS = 2000
"""Markers beyond which a printed panel holds them as a picture of pixels: its file stays small."""

TOLERANCE_LINE = Style("#666666", dash=DASHED, width=0.6)
EDGE_LINE = Style("#555555", dash=DOTTED, width=0.7)
STEP_ERROR = Style("#8c8c8c", size=2.5, width=2.5)


def overview(report: Report) -> Figure:
    """Draw the reference's curves of all cases: over friction alone, the paper's Figure 3."""
    sweep = report.result.sweep
    curves = [
        Series(line.index, line, curve_style(number), case.numbers, hover="%{y:.2f} dB")
        for number, (case, line) in enumerate(report.reference_lines.items())
    ]
    marks: list[Mark] = [Rule("y", sweep.band.threshold_db, RULE), *curves]
    return Figure(
        FIGURE3,
        f"The reference at all {named_axes(sweep)} ({sweep.fewest_steps} steps a period or more)",
        [Panel(_frequency_axis(sweep, FREQUENCY_LABEL), _transmittance_axis(report), marks)],
        height=2.9,
        pixels=440,
        legend_columns=min(len(curves), 6),
        together=True,
        legend_title=named_axes(sweep, plural=False).replace("friction ratio", "friction ratio μλ̃_N [-]"),
    )


def responses(report: Report) -> list[Figure]:
    """Draw the paper's Figure 3, and the response of its unit cell, by the reference; none where nothing is known."""
    drawn = {
        FIGURE3: (f"The paper’s Figure 3: {report.result.sweep.ratios.cells} cells, by the reference", report.chain),
        "unit-cell": ("The unit cell, of two degrees of freedom, by the reference", report.unit_cell),
    }
    return [
        _response(name, caption, curves)
        for name, (caption, curves) in drawn.items()
        if any(np.isfinite(level).any() for _, level in curves.values())
    ]


def _response(name: str, caption: str, curves: Curves) -> Figure:
    lines = [
        Series(eta, level, curve_style(number), ratio(friction), hover="%{y:.2f} dB")
        for number, (friction, (eta, level)) in enumerate(curves.items())
    ]
    highest = float(np.nanmax([level for _, level in curves.values()])) + 5
    return Figure(
        name,
        caption,
        [
            Panel(
                Axis(FREQUENCY_LABEL), Axis("transmittance [dB]", (LOWEST_DB, highest)), [Rule("y", 0.0, RULE), *lines]
            )
        ],
        height=2.9,
        pixels=440,
        legend_columns=min(len(lines), 6),
        together=True,
        legend_title="friction ratio μλ̃_N [-]",
    )


def panel(report: Report, case: Case) -> Figure:
    """Draw one case: every variant over the reference, and below it their differences."""
    sweep, edges = report.result.sweep, report.edges
    variants = compared_variants(sweep)
    known = edges[(edges["variant"] == CONVERGED) & (edges["case"] == case)]["frequency_ratio"].dropna()
    lines = [Rule("x", eta, EDGE_LINE) for eta in known]
    line = report.reference_lines[case]
    reference = Series(line.index, line, Style("#000000"), REFERENCE.title, hover="%{y:.3f} dB")
    curves = {variant: report.curve(variant, case) for variant in variants}
    drawn = {variant: own for variant, own in curves.items() if (own["status"] == ResultStatus.CONVERGED).any()}
    upper = [_variant(sweep, *curve) for curve in drawn.items()]
    lower = [_difference(own, style_of(sweep, variant), variant.title, "markers") for variant, own in drawn.items()]
    tolerances = [Rule("y", sign * CONVERGED_TOLERANCE_DB, TOLERANCE_LINE) for sign in (-1, 1)]
    scheme = report.curve(REFERENCE, case)
    error = _difference(scheme, STEP_ERROR, "scheme's own step error", "lines+markers")
    threshold = Rule("y", sweep.band.threshold_db, RULE)
    largest = _largest_difference(report)
    return Figure(
        f"transmittance-{file_name((case,))}",
        case.title.capitalize(),
        [
            Panel(_frequency_axis(sweep), _transmittance_axis(report), [*lines, threshold, reference, *upper]),
            Panel(
                _frequency_axis(sweep, FREQUENCY_LABEL),
                difference_axis("difference [dB]", LINEAR_DB, DIFFERENCE_TICKS, largest),
                [*lines, Rule("y", 0.0, RULE), *tolerances, error, *lower],
            ),
        ],
        height=3.6 + 0.13 * math.ceil((len(variants) + 2) / 2),
        pixels=540,
        heights=(3, 2),
        together=True,
        dense=sum(map(len, curves.values())) > MOST_VECTOR_MARKERS,
    )


def _variant(sweep: Sweep, variant: Variant, curve: pd.DataFrame) -> Series:
    """Mark the steady states of one variant, with their verdicts."""
    points = curve[curve["status"] == ResultStatus.CONVERGED]
    return Series(
        points["frequency_ratio"], points["transmittance_db"], style_of(sweep, variant), variant.title, "markers",
        "%{y:.4f} dB, %{text}", list(points["verdict"]),
    )  # fmt: skip


def _difference(curve: pd.DataFrame, style: Style, name: str, draw: Draw) -> Series:
    """Mark by how much a curve is above the converged reference's, where that is above `FLOOR_DB`."""
    return Series(curve["frequency_ratio"], curve["baseline_db"], style, name, draw, "difference %{y:+.5f} dB")


def _frequency_axis(sweep: Sweep, label: str = "") -> Axis:
    return Axis(label, (sweep.frequency_ratios[0] - 0.03, sweep.frequency_ratios[-1] + 0.03))


def _transmittance_axis(report: Report) -> Axis:
    """Give the axis of transmittance, from the lowest to the highest value, the same for all panels."""
    every = [*pd.concat(report.reference_lines.values()).dropna(), report.result.sweep.band.threshold_db]
    return Axis("transmittance [dB]", (max(LOWEST_DB, min(every) - 5), max(every) + 5))


def _largest_difference(report: Report) -> float:
    """Give the end of the axis of differences, the same for all panels [dB]."""
    drawn = report.points["variant"] != CONVERGED
    largest = float(report.points["baseline_db"][drawn].abs().max())
    return max(1.4 * CONVERGED_TOLERANCE_DB, 0.0 if math.isnan(largest) else 1.3 * largest)


MAP_LOWEST_DB, MAP_HIGHEST_DB = -60.0, 20.0
"""Range of the colours: beyond, curves show more."""


def friction_map_figure(data: FrictionMap) -> Figure:
    """Draw the map, with both edges of the band over friction."""
    colours = HeatMap(
        data.frequency_ratios, data.friction_ratios, data.transmittance_db, MAP_LOWEST_DB, MAP_HIGHEST_DB,
        "transmittance [dB]", "friction %{y}\nη_r %{x}\n%{z} dB",
    )  # fmt: skip
    first, last = data.frequency_ratios[[0, -1]]
    panel = Panel(
        Axis(FREQUENCY_LABEL, (first, last), grid=False),
        Axis("friction ratio μλ̃_N [-]", grid=False),
        [colours, *_edge(data, "lower edge", data.lower, SOLID), *_edge(data, "upper edge", data.upper, DASHED)],
    )
    return Figure(
        "friction-map",
        "Transmittance of the reference over friction and frequency [dB]; lines: lower (solid) and upper (dashed) "
        "edge of the attenuation band",
        [panel],
        height=2.9,
        pixels=430,
        legend_columns=0,
    )


def _edge(data: FrictionMap, name: str, edge: FloatArray, dash: tuple[float, ...]) -> list[Series]:
    """Draw an edge in white on black, to be seen on every colour."""
    friction, hover = data.friction_ratios, "friction %{y}\nη_r %{x:.3f}"
    return [
        Series(edge, friction, Style("#000000", size=3.8, width=2.6), draw="lines+markers"),
        Series(edge, friction, Style("#ffffff", size=2.6, dash=dash, width=1.4), name, "lines+markers", hover),
    ]
