"""Figure 3 of the paper, by the reference and by every engine with its differences; and over friction and frequency."""

import math
from collections.abc import Mapping
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from multibody_xval.engines.interface.tolerances import CONVERGED_TOLERANCE_DB, SCHEME_TOLERANCE_DB
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.data.descriptions import file_name, named_axes
from multibody_xval.reports.data.report import Report
from multibody_xval.reports.figures.drawing import (
    Drawing,
    hatched,
    legend,
    mathtext,
    set_difference_axis,
    small_multiples,
)
from multibody_xval.reports.figures.style import (
    COLUMN,
    GREY,
    MAP,
    PRINT_STYLE,
    RULE,
    by_panel,
    compared_variants,
    curve_style,
    preset_style,
)
from multibody_xval.reports.formatting import ratio
from multibody_xval.scenarios.runs.result import ResultStatus
from multibody_xval.scenarios.studies.friction_map import FrictionMap
from multibody_xval.scenarios.sweeps.sweep import Case, Sweep
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED, REFERENCE
from reference_lcp.validation import FloatArray

FREQUENCY_LABEL = "frequency ratio η_r = ω/ω_r [-]"
FRICTION_LABEL = "friction ratio μλ̃_N [-]"
LEVEL_LABEL = "transmittance [dB]"

FIGURE3 = "figure3"
"""Name of the figure of the reference's curves."""

LOWEST_DB = -80.0
"""Lowest transmittance that is drawn: beyond, the motion is less than the ten-thousandth part of the base's."""

LINEAR_DB = SCHEME_TOLERANCE_DB / 2
"""Differences below are drawn to scale, larger ones by their logarithm: the tightest tolerance is visible."""

DIFFERENCE_TICKS = (CONVERGED_TOLERANCE_DB, 10.0)

MOST_CURVES = 6
"""Curves in one panel: as many as can be told apart."""

MOST_MARKERS = 40
"""Points of a curve beyond which they are joined by a line, with gaps where there is no steady state."""

Lines = Mapping[str, tuple[FloatArray, FloatArray]]
"""Frequency ratios and transmittance [dB] of curves, by name."""


def overview(report: Report) -> Drawing:
    """Draw the reference's curves of all cases: over friction alone, the paper's Figure 3."""
    sweep = report.result.sweep
    curves = {case.numbers: (line.index.to_numpy(), line.to_numpy()) for case, line in report.reference_lines.items()}
    threshold = sweep.band.threshold_db
    caption = f"The reference at all {named_axes(sweep)} ({sweep.fewest_steps} steps a period or more)"
    title = named_axes(sweep, plural=False).replace("friction ratio", FRICTION_LABEL)
    limits = {"xlim": _frequencies(sweep), "ylim": _levels(report)}
    return _curves(FIGURE3, caption, curves, title, threshold, limits)


def responses(report: Report) -> list[Drawing]:
    """Draw the paper's Figure 3, and the response of its unit cell, by the reference; none where nothing is known."""
    shown = {
        FIGURE3: (f"The paper’s Figure 3: {report.result.sweep.ratios.cells} cells, by the reference", report.chain),
        "unit-cell": ("The unit cell, of two degrees of freedom, by the reference", report.unit_cell),
    }
    drawings = []
    for name, (caption, curves) in shown.items():
        if any(np.isfinite(level).any() for _, level in curves.values()):
            highest = float(np.nanmax([level for _, level in curves.values()])) + 5
            named = {ratio(friction): curve for friction, curve in curves.items()}
            drawings.append(_curves(name, caption, named, FRICTION_LABEL, 0.0, {"ylim": (LOWEST_DB, highest)}))
    return drawings


@mpl.rc_context(PRINT_STYLE)
def _curves(
    name: str, caption: str, curves: Lines, title: str, threshold: float, limits: Mapping[str, tuple[float, float]]
) -> Drawing:
    """Draw curves in one panel, or in a panel each, with the first in grey behind them."""
    if len(curves) > MOST_CURVES:
        return Drawing(name, caption, _apart(curves, threshold, limits))
    canvas = Figure(figsize=(COLUMN, 2.9), layout="constrained")
    axes = canvas.subplots()
    axes.axhline(threshold, **RULE)
    for number, (label, (eta, level)) in enumerate(curves.items()):
        axes.plot(eta, level, label=label, **curve_style(number))
    axes.set(xlabel=mathtext(FREQUENCY_LABEL), ylabel=LEVEL_LABEL, **limits)
    legend(canvas, title=mathtext(title))
    return Drawing(name, caption, canvas)


def _apart(curves: Lines, threshold: float, limits: Mapping[str, tuple[float, float]]) -> Figure:
    canvas, panels = small_multiples(list(curves), 0.9, x_label=FREQUENCY_LABEL, y_labels=[LEVEL_LABEL])
    first = next(iter(curves.values()))
    for (axes,), (eta, level) in zip(panels, curves.values(), strict=True):
        axes.axhline(threshold, **RULE)
        axes.plot(*first, **{**GREY, "label": None})
        axes.plot(eta, level, **curve_style(1))
        axes.set(**limits)
    return canvas


@mpl.rc_context(PRINT_STYLE)
def panel(report: Report, case: Case) -> Drawing:
    """Draw one case: every engine and formulation over the reference, and below it their differences."""
    sweep = report.result.sweep
    curves = {variant: report.curve(variant, case) for variant in compared_variants(sweep)}
    drawn = {variant: own for variant, own in curves.items() if (own["status"] == ResultStatus.CONVERGED).any()}
    groups = by_panel(drawn) or {REFERENCE.title: []}
    canvas, panels = small_multiples(
        list(groups), 2.05, parts=(6, 5), x_label=FREQUENCY_LABEL, y_labels=(LEVEL_LABEL, "difference [dB]")
    )
    for axes, variants in zip(panels, groups.values(), strict=True):
        _reference(report, case, *axes)
        for variant in variants:
            own, style = drawn[variant], _points(drawn[variant], variant)
            known = own["transmittance_db"].where(own["status"] == ResultStatus.CONVERGED)
            axes[0].plot(own["frequency_ratio"], known, **style)
            axes[1].plot(own["frequency_ratio"], own["baseline_db"], **style)
    legend(canvas)
    caption = f"{case.title.capitalize()}: engines over the reference, and their differences"
    return Drawing(f"transmittance-{file_name((case,))}", caption, canvas)


def _points(curve: pd.DataFrame, variant: Variant) -> dict[str, Any]:
    """Give the style of a curve: points, or a line through very many."""
    return preset_style(variant) | ({"marker": "none"} if len(curve) > MOST_MARKERS else {"linestyle": "none"})


def _reference(report: Report, case: Case, upper: Axes, lower: Axes) -> None:
    """Draw the reference, the scheme's own error, both edges of the band, and what is for orientation."""
    sweep, edges = report.result.sweep, report.edges
    line, scheme = report.reference_lines[case], report.curve(REFERENCE, case)
    for eta in edges[(edges["variant"] == CONVERGED) & (edges["case"] == case)]["frequency_ratio"].dropna():
        upper.axvline(eta, **RULE, linestyle=":")
        lower.axvline(eta, **RULE, linestyle=":")
    upper.axhline(sweep.band.threshold_db, **RULE)
    upper.plot(line.index, line, **GREY)
    lower.axhline(0.0, **RULE)
    for sign in (-1, 1):
        lower.axhline(sign * CONVERGED_TOLERANCE_DB, **RULE, linestyle="--")
    lower.plot(scheme["frequency_ratio"], scheme["baseline_db"], **{**GREY, "label": None})
    upper.set(xlim=_frequencies(sweep), ylim=_levels(report))
    lower.set(xlim=_frequencies(sweep))
    set_difference_axis(lower, "y", LINEAR_DB, DIFFERENCE_TICKS, _largest_difference(report))


def _frequencies(sweep: Sweep) -> tuple[float, float]:
    return sweep.frequency_ratios[0] - 0.03, sweep.frequency_ratios[-1] + 0.03


def _levels(report: Report) -> tuple[float, float]:
    """Give the lowest and the highest transmittance that is drawn, the same for all cases."""
    every = [*pd.concat(report.reference_lines.values()).dropna(), report.result.sweep.band.threshold_db]
    return max(LOWEST_DB, min(every) - 5), max(every) + 5


def _largest_difference(report: Report) -> float:
    """Give the end of the axis of differences, the same for all panels [dB]."""
    drawn = report.points["variant"] != CONVERGED
    largest = float(report.points["baseline_db"][drawn].abs().max())
    return max(1.4 * CONVERGED_TOLERANCE_DB, 0.0 if math.isnan(largest) else 2 * largest)


MAP_LOWEST_DB, MAP_HIGHEST_DB = -60.0, 20.0
"""Range of the colours: beyond, curves show more."""


@mpl.rc_context(PRINT_STYLE)
def friction_map_figure(data: FrictionMap) -> Drawing:
    """Draw the map, with both edges of the band over friction, in white on black, to be seen on every colour."""
    canvas = Figure(figsize=(COLUMN, 2.9), layout="constrained")
    axes = canvas.subplots()
    mesh = axes.pcolormesh(
        data.frequency_ratios, data.friction_ratios, data.transmittance_db, cmap=MAP, vmin=MAP_LOWEST_DB,
        vmax=MAP_HIGHEST_DB, shading="nearest", rasterized=True,
    )  # fmt: skip
    for edge, line in ((data.lower, "-"), (data.upper, (0, (5.0, 4.0)))):
        axes.plot(edge, data.friction_ratios, color="#000000", linewidth=2.6, marker="o", markersize=3.8)
        axes.plot(
            edge, data.friction_ratios, color="#fefefe", linewidth=1.4, linestyle=line, marker="o", markersize=2.0
        )
    canvas.colorbar(mesh, label=LEVEL_LABEL, extend="both")
    axes.set(xlim=data.frequency_ratios[[0, -1]], xlabel=mathtext(FREQUENCY_LABEL), ylabel=mathtext(FRICTION_LABEL))
    hatched(axes)
    caption = (
        "Transmittance of the reference over friction and frequency [dB]; lines: lower (solid) and upper (dashed) "
        "edge of the attenuation band"
    )
    return Drawing("friction-map", caption, canvas)
