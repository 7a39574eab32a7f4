"""Band edges as a forest: differences of all variants from the converged reference, with the reference's error bar."""

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engines.interface.variant import Variant
from reports.data.findings import blocked_reason
from reports.figures.figure import Picture, layout, rounded, significant
from reports.figures.scales import plot_scale, print_scale, stretched
from reports.figures.style import COLUMN, compared_variants, look_of
from scenarios.sweeps.attenuation_band import EDGE_RESOLUTION, Edge
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.sweep import Case
from scenarios.verdicts.pointwise import CONVERGED
from scenarios.verdicts.steady_case import REFERENCE

LINEAR = EDGE_RESOLUTION
"""Differences of η_r below are drawn to scale, larger ones by their logarithm."""

TICKS = (0.001, 0.01, 0.1)

Row = tuple[Case, Edge]

_TITLE = "difference of η<sub>r</sub> [-]"


def edge_forest(result: ComparedSweep) -> Picture:
    """Draw the differences of all band edges from the converged reference's, with what is allowed of each."""
    rows = _rows(result)
    return Picture(
        "band-edges",
        "Differences of the band edges from the converged reference's; bars: what is allowed of each, "
        "black around zero: of the reference",
        lambda: _printed(result, rows),
        {"data": _traces(result, rows), "layout": _layout(result, rows)},
    )


def reference_error(result: ComparedSweep, row: Row) -> float:
    """Error bar of the reference's edge in η_r: what is allowed of it; NaN where it was not compared."""
    return result.edge(REFERENCE, *row).comparison.tolerance


def _rows(result: ComparedSweep) -> list[Row]:
    """Edges that the converged reference has."""
    every = [(case, edge) for case in result.cases for edge in Edge]
    places = [(row, result.edge(CONVERGED, *row).frequency_ratio) for row in every]
    return [row for row, place in places if place is not None and not math.isnan(place)]


def _values(result: ComparedSweep, variant: Variant, rows: list[Row]) -> list[float]:
    return [result.edge(variant, *row).comparison.difference for row in rows]


def _allowed(result: ComparedSweep, variant: Variant, rows: list[Row]) -> list[float]:
    return [result.edge(variant, *row).comparison.tolerance for row in rows]


def _offsets(result: ComparedSweep) -> dict[Variant, float]:
    """Give every variant its place a little above or below the middle of a row; the reference has the middle."""
    variants = compared_variants(result.sweep)
    places = np.linspace(-0.32, 0.32, len(variants)) if len(variants) > 1 else np.zeros(1)
    return dict(zip(variants, places.tolist(), strict=False))


def _limit(result: ComparedSweep, rows: list[Row]) -> float:
    every = [
        abs(value) + allowed
        for variant in result.sweep.variants
        for value, allowed in zip(_values(result, variant, rows), _allowed(result, variant, rows), strict=True)
    ]
    return 1.6 * max((value for value in every if not math.isnan(value)), default=TICKS[0])


def _label(row: Row) -> str:
    return f"{row[0]}, {row[1]}"


def _printed(result: ComparedSweep, rows: list[Row]) -> Figure:
    variants = compared_variants(result.sweep)
    height = 1.2 + 0.13 * math.ceil(len(variants) / 2) + max(0.28, 0.035 * len(variants)) * max(len(rows), 1)
    figure = Figure(figsize=(COLUMN, height), layout="constrained")
    axes = figure.subplots()
    axes.axvline(0, color="0.4", linewidth=0.6)
    errors = [reference_error(result, row) for row in rows]
    if rows:
        axes.errorbar(
            np.zeros(len(rows)), range(len(rows)), xerr=errors, fmt="none", ecolor="black", elinewidth=1.4, capsize=3,
            label="Reference, error bar",
        )  # fmt: skip
    for variant, offset in _offsets(result).items():
        _print_variant(axes, result, variant, rows, offset)
    axes.set_yticks(range(len(rows)), [_label(row) for row in rows])
    axes.set_ylim(max(len(rows), 1) - 0.5, -0.5)
    axes.grid(axis="y", visible=False)
    print_scale(axes, "x", LINEAR, TICKS, _limit(result, rows))
    axes.tick_params(axis="x", labelrotation=30)
    axes.set_xlabel(r"difference of $\eta_r$ [-]")
    if rows:
        figure.legend(loc="outside upper center", ncols=2, columnspacing=1.0)
    return figure


def _print_variant(axes: Axes, result: ComparedSweep, variant: Variant, rows: list[Row], offset: float) -> None:
    if blocked_reason(result, variant) is None:
        look = look_of(result.sweep, variant).printed()
        places, values = np.arange(len(rows)) + offset, _values(result, variant, rows)
        axes.errorbar(values, places, xerr=_allowed(result, variant, rows), fmt="none", ecolor="0.6", elinewidth=0.6)
        axes.plot(values, places, label=variant.title, **look)


def _traces(result: ComparedSweep, rows: list[Row]) -> list[dict[str, Any]]:
    errors = [reference_error(result, row) for row in rows]
    bars = {
        "type": "scatter", "mode": "markers", "name": "Reference, error bar", "x": [0.0] * len(rows),
        "y": list(range(len(rows))), "marker": {"color": "#000", "symbol": "line-ns-open", "size": 8},
        "error_x": {"type": "data", "array": stretched(errors, LINEAR), "color": "#000", "thickness": 2, "width": 5},
        "customdata": significant(errors), "text": [_label(row) for row in rows],
        "hovertemplate": "%{text}<br>error bar ± %{customdata}",
    }  # fmt: skip
    traces = [bars]
    for variant, offset in _offsets(result).items():
        values = _values(result, variant, rows)
        if blocked_reason(result, variant) is not None:
            continue
        places = [result.edge(variant, *row).frequency_ratio for row in rows]
        texts = [f"{_label(row)}: {'–' if place is None else format(place, '.4f')}"
                 for row, place in zip(rows, places, strict=True)]  # fmt: skip
        traces.append(
            {
                "type": "scatter", "mode": "markers", "name": variant.title, "x": stretched(values, LINEAR),
                "y": [round(k + offset, 3) for k in range(len(rows))], "customdata": significant(values), "text": texts,
                "marker": look_of(result.sweep, variant).plotly_marker,
                "error_x": _bars(values, _allowed(result, variant, rows)),
                "hovertemplate": "%{text}<br>difference %{customdata}",
            }
        )  # fmt: skip
    return traces


def _bars(values: list[float], allowed: list[float]) -> dict[str, Any]:
    """Give the bars of plotly from a difference to what is allowed on either side of it, on the stretched scale."""
    middle, high, low = (
        np.arcsinh(np.array(ends) / LINEAR) for ends in (values, np.add(values, allowed), np.subtract(values, allowed))
    )
    return {
        "type": "data", "symmetric": False, "array": rounded(high - middle, 5), "arrayminus": rounded(middle - low, 5),
        "thickness": 0.8, "width": 0,
    }  # fmt: skip


def _layout(result: ComparedSweep, rows: list[Row]) -> dict[str, Any]:
    zero = {"type": "line", "xref": "x", "x0": 0, "x1": 0, "yref": "paper", "y0": 0, "y1": 1,
            "line": {"color": "#777", "width": 1}, "layer": "below"}  # fmt: skip
    names = {"tickmode": "array", "tickvals": list(range(len(rows))), "ticktext": [_label(row) for row in rows]}
    count = len(compared_variants(result.sweep))
    return layout(
        90 + max(44, 7 * count) * max(len(rows), 1),
        xaxis=plot_scale(_TITLE, LINEAR, TICKS, _limit(result, rows)),
        yaxis={"range": [max(len(rows), 1) - 0.5, -0.5], "automargin": True, "showgrid": False, "zeroline": False}
        | names,
        shapes=[zero],
    )
