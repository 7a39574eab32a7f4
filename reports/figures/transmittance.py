"""Figure 3 of the paper, by the reference; then by every engine, with its differences from the converged reference."""

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engines.interface.tolerances import CONVERGED_TOLERANCE_DB, SCHEME_TOLERANCE_DB
from engines.interface.variant import Variant
from reference_lcp.validation import FloatArray
from reports.data.findings import converged_edges, differences, file_name, named_axes, reference_line
from reports.figures.figure import Picture, axis, layout, rounded
from reports.figures.scales import plot_scale, print_scale, stretched
from reports.figures.style import COLUMN, compared_variants, curve_look, look_of
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.sweep import Case
from scenarios.sweeps.table import Point
from scenarios.verdicts.steady_case import REFERENCE

FREQUENCY_LABEL = r"frequency ratio $\eta_r = \omega/\omega_r$ [-]"
FREQUENCY_TITLE = "frequency ratio η<sub>r</sub> [-]"

LOWEST_DB = -80.0
"""Lowest transmittance that is drawn: beyond, the motion is less than the ten-thousandth part of the base's."""

LINEAR_DB = SCHEME_TOLERANCE_DB / 2
"""Differences below are drawn to scale, larger ones by their logarithm: the tightest tolerance is told from zero."""

DIFFERENCE_TICKS = (SCHEME_TOLERANCE_DB, CONVERGED_TOLERANCE_DB, 2.0, 10.0, 50.0)

CROWD = 2000
"""Markers beyond which a printed panel holds them as a picture of pixels: its file stays small."""


def overview(result: ComparedSweep) -> Picture:
    """Draw the reference's curves of all cases: over friction alone, the paper's Figure 3."""
    return Picture(
        "figure3",
        f"The reference at all {named_axes(result.sweep)} ({result.sweep.fewest_steps} steps a period or more)",
        lambda: _printed_overview(result),
        {"data": list(_overview_traces(result)), "layout": _overview_layout(result)},
    )


def panel(result: ComparedSweep, case: Case) -> Picture:
    """Draw one case: every variant over the reference, and below it their differences."""
    return Picture(
        f"transmittance-{file_name((case,))}",
        case.title.capitalize(),
        lambda: _printed_panel(result, case),
        {"data": _panel_traces(result, case), "layout": _panel_layout(result, case)},
        dense=_crowded(result, case),
    )


def _printed_overview(result: ComparedSweep) -> Figure:
    figure = Figure(figsize=(COLUMN, 2.9), layout="constrained")
    axes = figure.subplots()
    axes.axhline(result.sweep.band.threshold_db, color="0.4", linewidth=0.6)
    for place, case in enumerate(result.cases):
        colour, line, _ = curve_look(place)
        axes.plot(*reference_line(result, case), linestyle=line, color=colour, label=case.numbers)
    _transmittance_axis(axes, result)
    axes.set_xlabel(FREQUENCY_LABEL)
    figure.legend(
        title=_printed_title(result), loc="outside upper center",
        ncols=min(len(result.cases), 6), handlelength=2.2, columnspacing=1.0,
    )  # fmt: skip
    return figure


def _printed_title(result: ComparedSweep) -> str:
    """Name what tells the curves apart."""
    symbol = r"friction ratio $\mu\tilde{\lambda}_N$ [-]"
    return named_axes(result.sweep, plural=False).replace("friction ratio", symbol)


def _overview_traces(result: ComparedSweep) -> list[dict[str, Any]]:
    traces = []
    for place, case in enumerate(result.cases):
        colour, _, dash = curve_look(place)
        eta, curve = reference_line(result, case)
        traces.append(
            {
                "type": "scatter", "mode": "lines", "name": str(case),
                "x": rounded(eta), "y": rounded(curve, 3),
                "line": {"color": colour, "dash": dash, "width": 1.8},
                "hovertemplate": "η<sub>r</sub> %{x}<br>%{y:.2f} dB",
            }
        )  # fmt: skip
    return traces


def _overview_layout(result: ComparedSweep) -> dict[str, Any]:
    low, high = _decibel_range(result)
    return layout(
        440,
        xaxis=axis(FREQUENCY_TITLE, range=_frequency_range(result)),
        yaxis=axis("transmittance [dB]", range=[low, high]),
        shapes=[_level(result.sweep.band.threshold_db, "y")],
    )


def _printed_panel(result: ComparedSweep, case: Case) -> Figure:
    variants = compared_variants(result.sweep)
    rows = math.ceil((len(variants) + 2) / 2)
    figure = Figure(figsize=(COLUMN, 3.6 + 0.13 * rows), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    crowded = _crowded(result, case)
    for edge in converged_edges(result, case):
        for axes in (upper, lower):
            axes.axvline(edge, color="0.35", linewidth=0.7, linestyle=(0, (2, 2)))
    upper.axhline(result.sweep.band.threshold_db, color="0.4", linewidth=0.6)
    upper.plot(*reference_line(result, case), color="black", label=REFERENCE.title)
    _print_step_error(lower, result, case)
    for variant in variants:
        look = look_of(result.sweep, variant).printed() | {"rasterized": crowded, "label": variant.title}
        points = _drawn(result, variant, case)
        if points:
            upper.plot([p.frequency_ratio for p in points], [p.result.transmittance_db for p in points], **look)
            lower.plot(*differences(result, variant, case), **look)
    _transmittance_axis(upper, result)
    print_scale(lower, "y", LINEAR_DB, DIFFERENCE_TICKS, _largest_difference(result))
    lower.set_ylabel("difference [dB]")
    lower.set_xlabel(FREQUENCY_LABEL)
    handles = [one for axes in (upper, lower) for one in axes.get_legend_handles_labels()[0]]
    named = {str(handle.get_label()): handle for handle in handles}
    figure.legend(named.values(), named.keys(), loc="outside upper center", ncols=2, columnspacing=1.0)
    return figure


def _print_step_error(axes: Axes, result: ComparedSweep, case: Case) -> None:
    """Shade what the scheme itself errs by at the common time step, and mark the tolerance."""
    eta, error = differences(result, REFERENCE, case)
    axes.fill_between(eta, 0, error, color="0.8", linewidth=0)
    axes.plot(eta, error, color="black", linewidth=0.6, marker=".", markersize=2, label="scheme's own step error")
    axes.axhline(0, color="0.4", linewidth=0.6)
    for sign in (-1, 1):
        axes.axhline(sign * CONVERGED_TOLERANCE_DB, color="0.4", linewidth=0.6, linestyle=(0, (5, 4)))


def _transmittance_axis(axes: Axes, result: ComparedSweep) -> None:
    axes.set_ylim(*_decibel_range(result))
    axes.set_xlim(*_frequency_range(result))
    axes.set_ylabel("transmittance [dB]")


def _panel_traces(result: ComparedSweep, case: Case) -> list[dict[str, Any]]:
    eta, curve = reference_line(result, case)
    line = {
        "type": "scatter", "mode": "lines", "name": REFERENCE.title, "x": rounded(eta), "y": rounded(curve, 3),
        "line": {"color": "#000", "width": 1.6}, "hovertemplate": "η<sub>r</sub> %{x}<br>%{y:.3f} dB",
    }  # fmt: skip
    traces = [line, _difference_trace(result, REFERENCE, case, "scheme's own step error")]
    for variant in compared_variants(result.sweep):
        points = _drawn(result, variant, case)
        if points:
            traces += [_points_trace(result, variant, points), _difference_trace(result, variant, case)]
    return traces


def _points_trace(result: ComparedSweep, variant: Variant, points: list[Point]) -> dict[str, Any]:
    """Mark the steady states of one variant, with their verdicts."""
    return {
        "type": "scatter", "mode": "markers", "name": variant.title, "legendgroup": str(variant),
        "x": rounded(p.frequency_ratio for p in points), "y": rounded(p.result.transmittance_db for p in points),
        "text": [str(point.comparison.verdict) for point in points],
        "marker": look_of(result.sweep, variant).plotly_marker,
        "hovertemplate": "η<sub>r</sub> %{x}<br>%{y:.4f} dB, %{text}",
    }  # fmt: skip


def _difference_trace(result: ComparedSweep, variant: Variant, case: Case, name: str | None = None) -> dict[str, Any]:
    """Mark the differences of one variant, in the lower panel; the reference's as a grey line."""
    eta, difference = differences(result, variant, case)
    trace = {
        "type": "scatter", "yaxis": "y2", "name": name or variant.title, "legendgroup": str(variant),
        "x": rounded(eta), "y": stretched(difference, LINEAR_DB), "customdata": rounded(difference, 5),
        "hovertemplate": "η<sub>r</sub> %{x}<br>difference %{customdata:+.5f} dB",
    }  # fmt: skip
    if variant == REFERENCE:
        return trace | {"mode": "lines", "line": {"color": "#8c8c8c", "width": 4}}
    return trace | {"mode": "markers", "showlegend": False, "marker": look_of(result.sweep, variant).plotly_marker}


def _panel_layout(result: ComparedSweep, case: Case) -> dict[str, Any]:
    tolerances = [
        _level(sign * float(np.arcsinh(CONVERGED_TOLERANCE_DB / LINEAR_DB)), "y2", "dash") for sign in (-1, 1)
    ]
    low, high = _decibel_range(result)
    difference = plot_scale("difference [dB]", LINEAR_DB, DIFFERENCE_TICKS, _largest_difference(result))
    return layout(
        540,
        xaxis=axis(FREQUENCY_TITLE, range=_frequency_range(result), anchor="y2"),
        yaxis=axis("transmittance [dB]", range=[low, high], domain=[0.43, 1]),
        yaxis2={**difference, "domain": [0, 0.36]},
        shapes=[
            _level(result.sweep.band.threshold_db, "y"),
            *tolerances,
            *(_edge_line(edge) for edge in converged_edges(result, case)),
        ],
    )


def _level(value: float, which: str, dash: str = "solid") -> dict[str, Any]:
    """Draw a level across one panel."""
    line = {"color": "#777", "width": 1, "dash": dash}
    return {"type": "line", "xref": "paper", "x0": 0, "x1": 1, "yref": which, "y0": value, "y1": value, "line": line,
            "layer": "below"}  # fmt: skip


def _edge_line(eta: float) -> dict[str, Any]:
    """Draw an edge of the band through both panels."""
    line = {"color": "#555", "width": 1, "dash": "dot"}
    return {"type": "line", "xref": "x", "x0": eta, "x1": eta, "yref": "paper", "y0": 0, "y1": 1, "line": line,
            "layer": "below"}  # fmt: skip


def _crowded(result: ComparedSweep, case: Case) -> bool:
    """Whether a panel has more markers than a file should hold one by one."""
    return sum(len(result.curve(one, case)) for one in compared_variants(result.sweep)) > CROWD


def _drawn(result: ComparedSweep, variant: Variant, case: Case) -> list[Point]:
    return [point for point in result.curve(variant, case) if point.result.converged]


def _frequency_range(result: ComparedSweep) -> list[float]:
    return [result.sweep.frequency_ratios[0] - 0.03, result.sweep.frequency_ratios[-1] + 0.03]


def _decibel_range(result: ComparedSweep) -> tuple[float, float]:
    """Cut the axis off where nothing is to be seen, the same for all panels."""
    every = np.concatenate([reference_line(result, case)[1] for case in result.cases])
    known = np.append(every[np.isfinite(every)], result.sweep.band.threshold_db)
    return max(LOWEST_DB, float(known.min()) - 5), float(known.max()) + 5


def _largest_difference(result: ComparedSweep) -> float:
    """Give the end of the axis of differences, the same for all panels [dB]."""
    found: list[FloatArray] = [
        differences(result, variant, case)[1]
        for variant in (REFERENCE, *compared_variants(result.sweep))
        for case in result.cases
    ]
    every = np.concatenate(found)
    return max(1.4 * CONVERGED_TOLERANCE_DB, 1.3 * float(np.max(np.abs(every[np.isfinite(every)]), initial=0.0)))
