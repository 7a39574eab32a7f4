"""Errors to the truth: engines as installed and tuned, over cases and frequency, over the step."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from engines.interface.variant import Variant
from reference_lcp.validation import FloatArray
from reports.data.points import by_variant
from reports.data.variants import Errors
from reports.drawing.figure import Axis, Figure, HeatMap, Mark, Panel, Rule, Series
from reports.drawing.style import DASHED, DOTTED, Style, style_of
from reports.formatting import signed
from scenarios.studies.work_precision import StepPoint
from scenarios.sweeps.sweep import Case, Sweep
from scenarios.sweeps.truths import WRONG_DB
from scenarios.verdicts.finding import FLOOR_DB
from scenarios.verdicts.steady_case import CONVERGED, REFERENCE

JOINING = Style("#9aa4ae", width=2.0)
PRESETS = {
    "as installed": Style("#D55E00", "circle", 7.0),
    "recommended": Style("#009E73", "square", 5.0),
    "tuned": Style("#0072B2", "dot", 6.5),
    "other presets": Style("#8c8c8c", "diamond", 5.0),
}
NAMED = dict(zip(("default", "recommended", "tuned"), PRESETS, strict=False))
"""Titles of presets that have one, by name."""
LIMIT = Style("#666666", dash=DASHED, width=0.7)


def installed_figure(errors: Errors, where: str) -> Figure | None:
    """Draw a row an engine and formulation, the largest error on top; ``None`` without any but the reference's."""
    rows: dict[str, list[Any]] = {}
    for variant, own in errors.items():
        if variant.engine != REFERENCE.engine and own.size > 0:
            rows.setdefault(variant.tuned.title, []).append(own)
    if not rows:
        return None
    rows = dict(sorted(rows.items(), key=lambda row: -max(own.size for own in row[1])))
    count = len(rows)
    ends = [own.size for row in rows.values() for own in row]
    panel = Panel(
        Axis("largest error [dB]", (min(0.5 * min(ends), 0.01), 2 * max(*ends, WRONG_DB)), "log"),
        Axis(range=(count - 0.5, -0.5), ticks={float(k): name for k, name in enumerate(rows)}, grid=False),
        [Rule("x", WRONG_DB, LIMIT), *_marks(list(rows.values()))],
    )
    return Figure(
        "installed",
        f"Largest error of transmittance at {where}; dashed: {WRONG_DB:g} dB, from which on an engine is wrong",
        [panel],
        height=0.9 + 0.27 * count,
        pixels=70 + 34 * count,
        legend_columns=3,
    )


def _marks(rows: list[list[Any]]) -> list[Mark]:
    """Give the lines from the smallest to the largest error of each row, and the presets above them."""
    joining = [
        Series([min(sizes), max(sizes)], [k, k], JOINING)
        for k, row in enumerate(rows)
        if len(sizes := [own.size for own in row]) > 1
    ]
    presets: dict[str, list[tuple[float, Any]]] = {title: [] for title in PRESETS}
    for k, own in ((k, own) for k, row in enumerate(rows) for own in row):
        title = NAMED.get(own.variant.preset_name, "other presets")
        presets[title].append((float(k), own))
    return [*joining, *(_preset(title, own) for title, own in presets.items() if own)]


def _preset(title: str, own: list[tuple[float, Any]]) -> Series:
    places = [f"{row.worst_case.numbers}, {row.worst_frequency_ratio:.6g}" for _, row in own]
    return Series(
        [row.size for _, row in own], [k for k, _ in own], PRESETS[title], title, "markers", "%{text}\n%{x:.4g} dB",
        [f"{row.variant.title}, at ({place})" for (_, row), place in zip(own, places, strict=True)],
    )  # fmt: skip


LOWEST_DB = 1e-3
HIGHEST_DB = 10.0
"""Ends of the colours, the same in every report: what no curve shows, and thrice what is wrong."""

UNSTEADY = Style("#d55e00", "x-thin", 3.0)

COLUMNS = 3
"""Most maps side by side."""

INCHES_A_ROW, PIXELS_A_ROW = 0.13, 17
"""Height of a case in a map, in print and on the page."""


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


def error_map_figure(maps: Mapping[Variant, pd.DataFrame], lost: pd.DataFrame, rows: str) -> Figure:
    """Draw the maps of all variants, with the points that are `lost`; `rows` names what their rows are."""
    columns = min(COLUMNS, len(maps))
    lines = -(-len(maps) // columns)
    cases = max(map(len, maps.values()))
    crosses = by_variant(lost, maps)
    return Figure(
        "error-map",
        f"Error of transmittance to the truth over {rows} and frequency: size, in colours that are common to all "
        "variants",
        [_panel(variant, own, crosses[variant]) for variant, own in maps.items()],
        height=0.6 + lines * (0.65 + INCHES_A_ROW * cases),
        pixels=40 + lines * (95 + PIXELS_A_ROW * cases),
        columns=columns,
        legend_columns=int(any(len(own) for own in crosses.values())),
        x_label="frequency ratio η_r [-]",
        y_label=rows,
        wide=True,
        dense=True,
    )


def _panel(variant: Variant, errors: pd.DataFrame, lost: pd.DataFrame) -> Panel:
    etas, places = errors.columns.to_numpy(), {case: float(row) for row, case in enumerate(errors.index)}
    notes = [
        [f"{case.numbers}: {signed(error)} dB" for error in row]
        for case, row in zip(places, errors.to_numpy(), strict=True)
    ]
    size = np.maximum(errors.abs().to_numpy(), LOWEST_DB)
    marks: list[Mark] = [
        HeatMap(
            etas, np.array(list(places.values())), size, LOWEST_DB, HIGHEST_DB, "error to truth [dB]",
            "η_r %{x}\n%{text}", "log", notes,
        )
    ]  # fmt: skip
    if len(lost):
        rows = [places[case] for case in lost["case"]]
        what = "no steady state"
        marks.append(Series(lost["frequency_ratio"], rows, UNSTEADY, what, "markers", f"{what} at η_r %{{x}}"))
    ticks = {row: case.numbers for case, row in places.items()}
    return Panel(Axis(range=(etas[0], etas[-1]), grid=False), Axis(ticks=ticks, grid=False), marks, variant.title)


SMALLEST_DB = 1e-5
"""Errors below are drawn here: less than the steady states of engines repeat to."""

MOST_VECTOR_POINTS = 40
"""Points beyond which the page has a still picture of pixels, a quarter of the drawing's size."""


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


def work_precision_figure(sweep: Sweep, drawn: Curves) -> Figure:
    """Draw the error over the time of a simulated second and over the time to the steady state."""
    steps = _steps(drawn)
    whole = _series(sweep, drawn, lambda point: point.seconds)
    return Figure(
        "work-precision",
        "Work and precision: error over the time of a simulated second, and over that to a certified steady state; "
        f"points of one variant from {steps[0]} to {steps[-1]} steps a period are joined",
        [
            _speed_panel(sweep, drawn),
            Panel(Axis("time to the steady state [s]", scale="log"), Axis(scale="log"), whole),
        ],
        height=2.9 + 0.13 * (len(drawn) // 4),
        pixels=430,
        columns=2,
        legend_columns=4,
        wide=True,
        dense=_is_dense(drawn),
    )


def speed_figure(sweep: Sweep, drawn: Curves) -> Figure:
    """Draw the error over the time of a simulated second alone."""
    steps = _steps(drawn)
    return Figure(
        "work-precision",
        "Work and precision: error over the time of a simulated second",
        [_speed_panel(sweep, drawn)],
        height=2.9 + 0.13 * len(drawn),
        pixels=430,
        legend_columns=1 if len(drawn) < MOST_ROWS else 2,
        legend_title=f"error to the proven truth, with {steps[0]} to {steps[-1]} steps a period",
    )


def _speed_panel(sweep: Sweep, drawn: Curves) -> Panel:
    series = _series(sweep, drawn, lambda point: 1e3 * point.simulated_second)
    label = "time of a simulated second, seven cells [ms]"
    return Panel(Axis(label, scale="log"), Axis(ERROR_LABEL, scale="log"), series)


def convergence_figure(sweep: Sweep, drawn: Curves) -> Figure:
    """Draw the error over the number of steps a period, with the slope of a first-order scheme."""
    ticks = {float(step): str(step) for step in _steps(drawn)}
    lines = [*_series(sweep, drawn, lambda point: point.steps_per_period), *_first_order(drawn)]
    return Figure(
        "convergence",
        "Convergence in the time step",
        [Panel(Axis("steps a period [-]", scale="log", ticks=ticks), Axis(ERROR_LABEL, scale="log"), lines)],
        height=2.9 + 0.13 * (len(drawn) // 2),
        pixels=430,
        dense=_is_dense(drawn),
    )


def _steps(drawn: Curves) -> list[int]:
    return sorted({point.steps_per_period for own in drawn.values() for point in own})


def _is_dense(drawn: Curves) -> bool:
    return sum(map(len, drawn.values())) > MOST_VECTOR_POINTS


def _series(sweep: Sweep, drawn: Curves, cost: Callable[[StepPoint], float]) -> list[Mark]:
    return [
        Series(
            [cost(point) for point in own], _shown(own), style_of(sweep, variant), variant.title, "lines+markers",
            "%{text} at %{x}",
            [f"{point.steps_per_period} steps a period\nerror {point.error_db:.4g} dB" for point in own],
        )
        for variant, own in drawn.items()
    ]  # fmt: skip


def _shown(points: Iterable[StepPoint]) -> list[float]:
    return [max(point.error_db, SMALLEST_DB) for point in points]


def _first_order(drawn: Curves) -> list[Series]:
    """Give a line of slope −1 through the middle of all errors at the fewest steps."""
    ends = [own[0] for own in drawn.values() if len(own) > 1]
    if not ends:
        return []
    first = min(point.steps_per_period for point in ends)
    last = max(own[-1].steps_per_period for own in drawn.values())
    start = float(np.median(_shown(point for point in ends if point.steps_per_period == first)))
    line = Style("#888888", dash=DOTTED, width=0.7)
    return [Series([first, last], [start, start * first / last], line, "first order")]
