"""What accuracy costs, and how it grows with the number of steps: for every engine, formulation and preset."""

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from engines.interface.variant import Variant
from reference_lcp.accuracy.convergence import STICK_SLIP_POINTS
from reports.figures.figure import Picture, axis, layout, significant
from reports.figures.style import COLUMN, PAGE_WIDTH, look_of
from scenarios.studies.work_precision import StepPoint
from scenarios.sweeps.sweep import Sweep

SMALLEST_DB = 1e-5
"""Errors below are drawn here: less than the steady states of engines repeat to."""

ERROR_LABEL = "largest error at six points [dB]"

Curves = dict[Variant, list[StepPoint]]


def curves(points: Iterable[StepPoint]) -> Curves:
    """Give the points of each variant whose error is over all six places, by number of steps.

    An error over fewer would be of other places, and a curve through it no convergence.
    """
    found: Curves = {}
    for point in points:
        if point.certified == len(STICK_SLIP_POINTS) and not math.isnan(point.error_db):
            found.setdefault(point.variant, []).append(point)
    return found


def work_precision(sweep: Sweep, points: Sequence[StepPoint]) -> Picture:
    """Draw the error over the cost of a step and over the time to the steady state."""
    drawn = curves(points)
    costs = [("µs a step", "step_seconds", 1e6), ("seconds to the steady state", "seconds", 1.0)]
    data = [
        _trace(sweep, variant, found, [scale * getattr(one, name) for one in found], panel)
        for panel, (_, name, scale) in enumerate(costs, 1)
        for variant, found in drawn.items()
    ]
    plot = layout(
        430,
        grid={"rows": 1, "columns": 2, "pattern": "independent", "xgap": 0.12},
        xaxis=_log_axis(f"{costs[0][0]} (chain of seven cells)"),
        xaxis2=_log_axis(f"{costs[1][0]} [s]"),
        yaxis=_log_axis(ERROR_LABEL),
        yaxis2=_log_axis("", matches="y", showticklabels=False),
    )
    return Picture(
        "work-precision",
        "Work and precision: error over the cost of a step, and over the time to a certified steady state; "
        "points of one variant from 400 to 1600 steps a period are joined",
        lambda: _printed_work(sweep, drawn, costs),
        {"data": data, "layout": plot},
        wide=True,
    )


def convergence(sweep: Sweep, points: Sequence[StepPoint]) -> Picture:
    """Draw the error over the number of steps a period, with the slope of a first-order scheme."""
    drawn = curves(points)
    data = [_trace(sweep, v, found, [one.steps_per_period for one in found], 1) for v, found in drawn.items()]
    guide = _first_order(drawn)
    if guide is not None:
        line = {"color": "#888", "width": 1, "dash": "dot"}
        data.append(
            {"type": "scatter", "mode": "lines", "name": "first order", "x": guide[0], "y": guide[1], "line": line,
             "hoverinfo": "skip"}
        )  # fmt: skip
    steps = sorted({one.steps_per_period for found in drawn.values() for one in found})
    ticks = {"tickmode": "array", "tickvals": steps, "ticktext": [str(step) for step in steps]}
    plot = layout(430, xaxis=_log_axis("steps a period [-]") | ticks, yaxis=_log_axis(ERROR_LABEL))
    return Picture(
        "convergence", "Convergence in the time step", lambda: _printed_convergence(sweep, drawn),
        {"data": data, "layout": plot},
    )  # fmt: skip


def _trace(sweep: Sweep, variant: Variant, found: list[StepPoint], cost: Sequence[float], panel: int) -> dict[str, Any]:
    """Draw one variant in one panel."""
    look = look_of(sweep, variant)
    number = "" if panel == 1 else str(panel)
    texts = [f"{one.steps_per_period} steps a period" for one in found]
    return {
        "type": "scatter", "mode": "lines+markers", "name": variant.title, "legendgroup": str(variant),
        "showlegend": panel == 1, "xaxis": f"x{number}", "yaxis": f"y{number}",
        "x": significant(cost), "y": significant(_shown(found)),
        "customdata": significant([one.error_db for one in found]), "text": texts,
        "marker": _marker(variant, look.plotly_marker), "line": look.plotly_line,
        "hovertemplate": "%{text}<br>error %{customdata} dB at %{x}",
    }  # fmt: skip


def _marker(variant: Variant, marker: dict[str, Any]) -> dict[str, Any]:
    """Tell the converged reference from the reference, which share a look."""
    return marker | {"symbol": "cross-thin"} if variant.preset_name == "converged" else marker


def _shown(found: Iterable[StepPoint]) -> list[float]:
    return [max(one.error_db, SMALLEST_DB) for one in found]


def _log_axis(title: str, **more: Any) -> dict[str, Any]:
    return axis(title, type="log", exponentformat="power", dtick=1, **more)


def _first_order(drawn: Curves) -> tuple[list[float], list[float]] | None:
    """Give a line of slope −1 through the middle of all errors at the fewest steps."""
    ends = [found[0] for found in drawn.values() if len(found) > 1]
    if not ends:
        return None
    first = min(one.steps_per_period for one in ends)
    last = max(found[-1].steps_per_period for found in drawn.values())
    start = float(np.median(_shown(one for one in ends if one.steps_per_period == first)))
    return [first, last], [start, start * first / last]


def _print_curve(axes: Axes, sweep: Sweep, variant: Variant, found: list[StepPoint], cost: Sequence[float]) -> None:
    look = look_of(sweep, variant).printed(lines=True)
    if variant.preset_name == "converged":
        look |= {"marker": "+", "markersize": 6}
    axes.plot(cost, _shown(found), label=variant.title, **look)


def _printed_work(sweep: Sweep, drawn: Curves, costs: Sequence[tuple[str, str, float]]) -> Figure:
    figure = Figure(figsize=(PAGE_WIDTH, 2.9 + 0.13 * (len(drawn) // 4)), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    for axes, (title, name, scale) in zip(panels, costs, strict=True):
        for variant, found in drawn.items():
            _print_curve(axes, sweep, variant, found, [scale * getattr(one, name) for one in found])
        axes.set(xscale="log", yscale="log", xlabel=title)
    panels[0].set_ylabel(ERROR_LABEL)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=4, columnspacing=1.0)
    return figure


def _printed_convergence(sweep: Sweep, drawn: Curves) -> Figure:
    figure = Figure(figsize=(COLUMN, 2.9 + 0.13 * (len(drawn) // 2)), layout="constrained")
    axes = figure.subplots()
    for variant, found in drawn.items():
        _print_curve(axes, sweep, variant, found, [one.steps_per_period for one in found])
    guide = _first_order(drawn)
    if guide is not None:
        axes.plot(*guide, color="0.5", linewidth=0.7, linestyle=":", label="first order")
    axes.set(xscale="log", yscale="log", xlabel="steps a period [-]", ylabel=ERROR_LABEL)
    steps = sorted({one.steps_per_period for found in drawn.values() for one in found})
    axes.set_xticks(steps, [str(step) for step in steps])
    axes.xaxis.set_minor_formatter(NullFormatter())
    figure.legend(loc="outside upper center", ncols=2, columnspacing=1.0)
    return figure
