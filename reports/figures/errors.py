"""Errors to the truth: engines as installed and tuned, over cases and frequency, over the step."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.data.points import by_variant
from multibody_xval.reports.data.variants import Errors
from multibody_xval.reports.figures.drawing import Drawing, hatched, legend, place_of, set_ticks, small_multiples
from multibody_xval.reports.figures.style import (
    COLUMN,
    GREY,
    MAP,
    PRESETS,
    PRINT_STYLE,
    RULE,
    by_panel,
    preset_style,
    preset_title,
)
from multibody_xval.reports.formatting import ratio
from multibody_xval.scenarios.studies.work_precision import StepPoint
from multibody_xval.scenarios.sweeps.sweep import Case
from multibody_xval.scenarios.sweeps.truths import WRONG_DB
from multibody_xval.scenarios.verdicts.finding import FLOOR_DB
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED, REFERENCE
from reference_lcp.validation import FloatArray

LIMIT: dict[str, Any] = {**RULE, "linestyle": "--"}


@mpl.rc_context(PRINT_STYLE)
def installed_figure(errors: Errors, where: str) -> Drawing | None:
    """Draw a row an engine and formulation, the largest error on top; ``None`` without any but the reference's."""
    rows: dict[str, list[Any]] = {}
    for variant, own in errors.items():
        if variant.engine != REFERENCE.engine and own.size > 0:
            rows.setdefault(variant.tuned.title, []).append(own)
    if not rows:
        return None
    rows = dict(sorted(rows.items(), key=lambda row: -max(own.size for own in row[1])))
    ends = [own.size for row in rows.values() for own in row]
    canvas = Figure(figsize=(COLUMN, 0.9 + 0.2 * len(rows)), layout="constrained")
    axes = canvas.subplots()
    axes.axvline(WRONG_DB, **LIMIT)
    _draw_presets(axes, list(rows.values()))
    axes.set(xscale="log", xlim=(min(0.5 * min(ends), 0.01), 2 * max(*ends, WRONG_DB)), xlabel="largest error [dB]")
    axes.set_ylim(len(rows) - 0.5, -0.5)
    axes.grid(axis="y", visible=False)
    set_ticks(axes, "y", {float(k): name for k, name in enumerate(rows)})
    legend(canvas, 3)
    caption = f"Largest error of transmittance at {where}; dashed: {WRONG_DB:g} dB, from which on an engine is wrong"
    return Drawing("installed", caption, canvas)


def _draw_presets(axes: Axes, rows: list[list[Any]]) -> None:
    """Draw a line from the smallest to the largest error of each row, and the presets on it."""
    for k, row in enumerate(rows):
        sizes = [own.size for own in row]
        axes.plot([min(sizes), max(sizes)], [k, k], color="#9aa4ae", linewidth=2.0)
    for title, style in PRESETS.items():
        own = [(row.size, k) for k, every in enumerate(rows) for row in every if preset_title(row.variant) == title]
        if own:
            axes.plot(*zip(*own, strict=True), **{**style, "linestyle": "none"}, label=title)


LOWEST_DB = 1e-3
HIGHEST_DB = 10.0
"""Ends of the colours, the same in every report: what no curve shows, and thrice what is wrong."""

UNSTEADY: dict[str, Any] = {
    "color": "#d55e00",
    "marker": "x",
    "markersize": 3.0,
    "linestyle": "none",
    "label": "no steady state",
}

ROW = 0.13
"""Height of a case in a map [inch]."""

MOST_ROWS = 24
"""Cases beyond which their rows are too thin to be told apart."""


def error_maps(points: pd.DataFrame, cases: Sequence[Case], order: Iterable[Variant]) -> dict[Variant, pd.DataFrame]:
    """Give the map of each of the variants in this order, but for the converged reference, which has next to no error.

    There is none where the sweep is one curve, or more than can be told apart, and none of a variant without errors.
    A map has a row a case and a column a frequency ratio of any case: transmittance less the true one [dB]; NaN where
    the truth is below `FLOOR_DB`, or there is no steady state; between a case's points, that of the nearest.
    """
    if not 1 < len(cases) <= MOST_ROWS:
        return {}
    etas = np.unique(points["frequency_ratio"].to_numpy(dtype=float))
    shown = points.assign(error_db=points["error_db"].where(points["truth_db"] > FLOOR_DB))
    groups = by_variant(shown)
    maps = {}
    for variant in (own for own in order if own != CONVERGED and own in groups):
        rows = [_nearest(groups[variant][groups[variant]["case"] == case], etas) for case in cases]
        if np.isfinite(rows).any():
            maps[variant] = pd.DataFrame(rows, index=list(cases), columns=etas)
    return maps


def _nearest(curve: pd.DataFrame, etas: FloatArray) -> FloatArray:
    if curve.empty:
        return np.full(etas.size, np.nan)
    nearest = np.abs(curve["frequency_ratio"].to_numpy(dtype=float) - etas[:, None]).argmin(axis=1)
    return curve["error_db"].to_numpy(dtype=float)[nearest]


def unsteady(points: pd.DataFrame) -> pd.DataFrame:
    """Give the points without a steady state that could be compared with the truth."""
    return points[points["error_db"].isna() & (points["truth_db"] > FLOOR_DB)]


@mpl.rc_context(PRINT_STYLE)
def error_map_figure(maps: Mapping[Variant, pd.DataFrame], lost: pd.DataFrame, rows: str) -> Drawing:
    """Draw the maps of all variants, with the points that are `lost`; `rows` names what their rows are."""
    cases = max(map(len, maps.values()))
    canvas, panels = small_multiples(
        [variant.title for variant in maps], ROW * cases, x_label="frequency ratio η_r [-]", y_labels=[rows]
    )
    crosses = by_variant(lost, maps)
    for (axes,), (variant, errors) in zip(panels, maps.items(), strict=True):
        mesh = _draw_map(axes, errors, crosses[variant])
    _draw_scale(canvas, mesh)
    legend(canvas, loc="upper left")
    caption = (
        f"Error of transmittance to the truth over {rows} and frequency: size, in colours that are common to all "
        "variants"
    )
    return Drawing("error-map", caption, canvas)


def _draw_scale(canvas: Figure, mesh: QuadMesh) -> None:
    """Draw the scale of colours above the panels, at the right."""
    place = place_of((4.6, canvas.get_figheight() - 0.14, 2.4, 0.08), canvas)
    scale = canvas.colorbar(mesh, cax=canvas.add_axes(place), orientation="horizontal", extend="both")
    decades = [float(f"1e{power}") for power in range(-3, 2)]
    scale.set_ticks(decades, labels=list(map(ratio, decades)))
    scale.ax.tick_params(labelsize=6.0, length=2.0, pad=1.0)
    label: dict[str, Any] = {"ha": "right", "va": "center", "transform": scale.ax.transAxes, "fontsize": 7.0}
    scale.ax.text(-0.08, 0.5, "error to truth [dB]", **label)


def _draw_map(axes: Axes, errors: pd.DataFrame, lost: pd.DataFrame) -> QuadMesh:
    etas, places = errors.columns.to_numpy(), {case: float(row) for row, case in enumerate(errors.index)}
    mesh = axes.pcolormesh(
        etas, np.array(list(places.values())), np.maximum(errors.abs().to_numpy(), LOWEST_DB), cmap=MAP,
        norm=LogNorm(LOWEST_DB, HIGHEST_DB), shading="nearest", rasterized=True,
    )  # fmt: skip
    hatched(axes)
    if len(lost):
        axes.plot(lost["frequency_ratio"], [places[case] for case in lost["case"]], **UNSTEADY)
    axes.set(xlim=(etas[0], etas[-1]), ylim=(-0.5, len(places) - 0.5))
    set_ticks(axes, "y", {row: case.numbers for case, row in places.items()})
    return mesh


SMALLEST_DB = 1e-5
"""Errors below are drawn here: less than the steady states of engines repeat to."""

ERROR_LABEL = "largest error at six points [dB]"

Curves = dict[Variant, list[StepPoint]]


def curves(points: Iterable[StepPoint]) -> Curves:
    """Give the points of each variant whose error is over all six points, by number of steps.

    An error over fewer points is not comparable, and a curve through it shows no convergence.
    """
    complete: Curves = {}
    for point in points:
        if point.is_complete and not math.isnan(point.error_db):
            complete.setdefault(point.variant, []).append(point)
    return complete


def work_precision_figures(drawn: Curves) -> list[Drawing]:
    """Draw the error over the time of a simulated second, over that to the steady state, and over the steps."""
    joined = "; points of one variant from {} to {} steps a period are joined".format(*_ends(drawn))
    return [
        speed_figure(drawn, joined),
        _cost_figure(
            "steady-state-time", f"Work and precision: error over the time to a certified steady state{joined}", drawn,
            lambda point: point.seconds, "time to the steady state [s]",
        ),
        _cost_figure(
            "convergence", "Convergence in the time step; dotted: first order", drawn,
            lambda point: point.steps_per_period, "steps a period [-]", _first_order(drawn),
        ),
    ]  # fmt: skip


def speed_figure(drawn: Curves, said: str = "") -> Drawing:
    """Draw the error over the time of a simulated second."""
    return _cost_figure(
        "work-precision", f"Work and precision: error over the time of a simulated second{said}", drawn,
        lambda point: 1e3 * point.simulated_second, "time of a simulated second, seven cells [ms]",
    )  # fmt: skip


@mpl.rc_context(PRINT_STYLE)
def _cost_figure(
    name: str, caption: str, drawn: Curves, cost: Callable[[StepPoint], float], label: str,
    line: tuple[list[float], list[float]] | None = None,
) -> Drawing:  # fmt: skip
    """Draw errors over what they cost: a panel an engine and formulation, the reference in grey in each."""
    groups = by_panel(variant for variant in drawn if variant.engine != REFERENCE.engine) or {REFERENCE.title: []}
    costs = [cost(point) for own in drawn.values() for point in own]
    known = [value for value in costs if math.isfinite(value)] or [1.0]
    errors = [error for own in drawn.values() for error in _shown(own)]
    canvas, panels = small_multiples(list(groups), 1.2, x_label=label, y_labels=[ERROR_LABEL])
    for (axes,), variants in zip(panels, groups.values(), strict=True):
        if line is not None:
            axes.plot(*line, **RULE, linestyle=":", label="first order")
        for variant in (own for own in drawn if own.engine == REFERENCE.engine):
            other = {} if variant == REFERENCE else {"label": variant.title, "linestyle": "--"}
            _draw_costs(axes, drawn[variant], cost, {**GREY, **other})
        for variant in variants:
            _draw_costs(axes, drawn[variant], cost, preset_style(variant))
        axes.set(xscale="log", yscale="log", ylim=(0.5 * min(errors), 2 * max(errors)))
        axes.set_xlim(0.7 * min(known), 1.4 * max(known))
    legend(canvas)
    return Drawing(name, caption, canvas)


def _draw_costs(axes: Axes, points: Sequence[StepPoint], cost: Callable[[StepPoint], float], style: Any) -> None:
    axes.plot([cost(point) for point in points], _shown(points), **style)


def _ends(drawn: Curves) -> tuple[int, int]:
    steps = [point.steps_per_period for own in drawn.values() for point in own]
    return min(steps), max(steps)


def _shown(points: Iterable[StepPoint]) -> list[float]:
    return [max(point.error_db, SMALLEST_DB) for point in points]


def _first_order(drawn: Curves) -> tuple[list[float], list[float]] | None:
    """Give a line of slope −1 through the middle of all errors at the fewest steps."""
    ends = [own[0] for own in drawn.values() if len(own) > 1]
    if not ends:
        return None
    first = min(point.steps_per_period for point in ends)
    last = max(own[-1].steps_per_period for own in drawn.values())
    start = float(np.median(_shown(point for point in ends if point.steps_per_period == first)))
    return [first, last], [start, start * first / last]
