"""Errors to the truth: engines as installed and tuned, over cases and frequency, over the step, over one option."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from engines.interface.variant import Variant
from reference_lcp.studies.against_exact import STICK_SLIP_POINTS
from reference_lcp.validation import FloatArray
from reports.data.options import OptionCurve
from reports.data.points import by_variant
from reports.data.variants import VariantErrors
from reports.drawing.figure import Axis, Figure, HeatMap, Mark, Panel, Rule, Series
from reports.drawing.style import DASHED, DOTTED, Style, style_of
from reports.formatting import ratio, signed
from scenarios.studies.work_precision import StepPoint
from scenarios.sweeps.sweep import Case, Sweep
from scenarios.sweeps.truths import WRONG_DB
from scenarios.verdicts.finding import FLOOR_DB
from scenarios.verdicts.steady_case import CONVERGED, REFERENCE

JOINING = Style("#9aa4ae", width=2.0)
DEFAULT = Style("#D55E00", "circle", 7.0)
TUNED = Style("#0072B2", "dot", 6.5)
OTHER = Style("#8c8c8c", "diamond", 5.0)
LIMIT = Style("#666666", dash=DASHED, width=0.7)

Row = dict[str, VariantErrors]
"""Errors of one formulation of an engine by preset."""


def installed_figure(errors: Mapping[Variant, VariantErrors]) -> Figure | None:
    """Draw a row an engine and formulation, the largest error on top; ``None`` without any but the reference's."""
    rows: dict[str, Row] = {}
    for variant, own in errors.items():
        if variant.engine != REFERENCE.engine and own.size > 0:
            rows.setdefault(variant.tuned.title, {})[variant.preset_name] = own
    if not rows:
        return None
    names = sorted(rows, key=lambda name: -max(own.size for own in rows[name].values()))
    count = len(names)
    ends = [own.size for row in rows.values() for own in row.values()]
    panel = Panel(
        Axis("largest error [dB]", (min(0.5 * min(ends), 0.01), 2 * max(*ends, WRONG_DB)), "log"),
        Axis(range=(count - 0.5, -0.5), ticks={float(k): name for k, name in enumerate(names)}, grid=False),
        [Rule("x", WRONG_DB, LIMIT), *_marks([rows[name] for name in names])],
    )
    return Figure(
        "installed",
        "Largest error of transmittance to the exact motion: engines as installed and with tuned options; dashed: "
        f"{WRONG_DB:g} dB, from which on a variant is wrong",
        [panel],
        height=0.9 + 0.27 * count,
        pixels=70 + 34 * count,
        legend_columns=3,
    )


def _marks(rows: list[Row]) -> list[Mark]:
    """Give the lines from the smallest to the largest error of each row, and the presets above them."""
    joining = [
        Series([min(sizes), max(sizes)], [k, k], JOINING)
        for k, row in enumerate(rows)
        if len(sizes := [own.size for own in row.values()]) > 1
    ]
    other = [name for row in rows for name in row if name not in ("default", "tuned")]
    presets = [("as installed", ("default",), DEFAULT), ("tuned", ("tuned",), TUNED), ("other presets", other, OTHER)]
    return [*joining, *(_preset(rows, title, names, style) for title, names, style in presets if _any(rows, names))]


def _any(rows: list[Row], names: Sequence[str]) -> bool:
    return any(name in row for row in rows for name in names)


def _preset(rows: list[Row], title: str, names: Sequence[str], style: Style) -> Series:
    every = [(k, own) for k, row in enumerate(rows) for name, own in row.items() if name in names]
    return Series(
        [own.size for _, own in every], [float(k) for k, _ in every], style, title, "markers", "%{text}\n%{x:.4g} dB",
        [f"{own.variant.title}, at ({_place(own)})" for _, own in every],
    )  # fmt: skip


def _place(own: VariantErrors) -> str:
    case = own.worst_case
    return f"{'' if case is None else case.numbers}, {own.worst_frequency_ratio:.6g}"


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


@dataclass(frozen=True)
class ErrorMap:
    """Errors of one variant over cases, from below, and frequency ratios, ascending: those of all cases together."""

    variant: Variant
    cases: tuple[Case, ...]
    frequency_ratios: FloatArray
    error_db: FloatArray
    """Transmittance less the true one [dB], shape (cases, frequency ratios); NaN where the truth is too small to be
    compared with, see `FLOOR_DB`, or there is no steady state. Between a case's points, that of the nearest."""
    unsteady: tuple[tuple[int, float], ...]
    """Points without a steady state that can be compared, as (number of the case, frequency ratio)."""


def error_maps(points: pd.DataFrame, cases: Sequence[Case], order: Iterable[Variant]) -> list[ErrorMap]:
    """Give the map of each of the variants in this order, but for the converged reference, which has next to no error.

    There is none where the sweep is one curve, or more than can be told apart, and none of a variant without errors.
    """
    if not 1 < len(cases) <= MOST_ROWS:
        return []
    etas = np.unique(points["frequency_ratio"].to_numpy(dtype=float))
    comparable = points[points["truth_db"] > FLOOR_DB]
    groups = by_variant(points.assign(error_db=comparable["error_db"]))
    maps = []
    for variant in (own for own in order if own != CONVERGED and own in groups):
        rows, unsteady = np.full((len(cases), etas.size), np.nan), []
        for number, case in enumerate(cases):
            own = groups[variant][groups[variant]["case"] == case]
            missing = own[own["error_db"].isna() & (own["truth_db"] > FLOOR_DB)]
            unsteady += [(number, float(eta)) for eta in missing["frequency_ratio"]]
            if len(own):
                nearest = np.abs(own["frequency_ratio"].to_numpy(dtype=float) - etas[:, None]).argmin(axis=1)
                rows[number] = own["error_db"].to_numpy(dtype=float)[nearest]
        if np.isfinite(rows).any():
            maps.append(ErrorMap(variant, tuple(cases), etas, rows, tuple(unsteady)))
    return maps


def error_map_figure(maps: Sequence[ErrorMap], rows: str) -> Figure:
    """Draw the maps of all variants; `rows` names what their rows are."""
    columns = min(COLUMNS, len(maps))
    lines = -(-len(maps) // columns)
    cases = len(maps[0].cases)
    return Figure(
        "error-map",
        f"Error of transmittance to the truth over {rows} and frequency: size, in colours that are common to all "
        "variants",
        [_panel(own) for own in maps],
        height=0.6 + lines * (0.65 + INCHES_A_ROW * cases),
        pixels=40 + lines * (95 + PIXELS_A_ROW * cases),
        columns=columns,
        legend_columns=int(any(own.unsteady for own in maps)),
        x_label="frequency ratio η_r [-]",
        y_label=rows,
        wide=True,
        dense=True,
    )


def _panel(own: ErrorMap) -> Panel:
    rows = np.arange(len(own.cases), dtype=float)
    size = np.maximum(np.abs(own.error_db), LOWEST_DB)
    notes = [
        [f"{case.numbers}: {signed(error, 4)} dB" for error in row]
        for case, row in zip(own.cases, own.error_db, strict=True)
    ]
    marks: list[Mark] = [
        HeatMap(
            own.frequency_ratios,
            rows,
            size,
            LOWEST_DB,
            HIGHEST_DB,
            "error to truth [dB]",
            "η_r %{x}\n%{text}",
            "log",
            notes,
        )
    ]
    if own.unsteady:
        places, etas = zip(*own.unsteady, strict=True)
        marks.append(Series(etas, places, UNSTEADY, "no steady state", "markers", "no steady state at η_r %{x}"))
    ticks = {float(row): case.numbers for row, case in zip(rows, own.cases, strict=True)}
    return Panel(
        Axis(range=(own.frequency_ratios[0], own.frequency_ratios[-1]), grid=False),
        Axis(ticks=ticks, grid=False),
        marks,
        own.variant.title,
    )


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
        if point.certified == len(STICK_SLIP_POINTS) and not math.isnan(point.error_db):
            complete.setdefault(point.variant, []).append(point)
    return complete


def steps_of(drawn: Curves) -> list[int]:
    """Give the steps a period of all curves, ascending."""
    return sorted({point.steps_per_period for own in drawn.values() for point in own})


def work_precision_figure(sweep: Sweep, points: Sequence[StepPoint]) -> Figure:
    """Draw the error over the cost of a step and over the time to the steady state."""
    drawn = curves(points)
    steps = steps_of(drawn)
    return Figure(
        "work-precision",
        "Work and precision: error over the cost of a step, and over the time to a certified steady state; "
        f"points of one variant from {steps[0]} to {steps[-1]} steps a period are joined",
        [
            Panel(
                Axis("time of a step, seven cells [µs]", scale="log"), Axis(ERROR_LABEL, scale="log"),
                _series(sweep, drawn, lambda point: 1e6 * point.step_seconds),
            ),
            Panel(
                Axis("time to the steady state [s]", scale="log"), Axis(scale="log"),
                _series(sweep, drawn, lambda point: point.seconds),
            ),
        ],
        height=2.9 + 0.13 * (len(drawn) // 4),
        pixels=430,
        columns=2,
        legend_columns=4,
        wide=True,
        dense=_is_dense(drawn),
    )  # fmt: skip


def convergence_figure(sweep: Sweep, points: Sequence[StepPoint]) -> Figure:
    """Draw the error over the number of steps a period, with the slope of a first-order scheme."""
    drawn = curves(points)
    steps = steps_of(drawn)
    return Figure(
        "convergence",
        "Convergence in the time step",
        [
            Panel(
                Axis("steps a period [-]", scale="log", ticks={float(step): str(step) for step in steps}),
                Axis(ERROR_LABEL, scale="log"),
                [*_series(sweep, drawn, lambda point: point.steps_per_period), *_first_order(drawn)],
            )
        ],
        height=2.9 + 0.13 * (len(drawn) // 2),
        pixels=430,
        dense=_is_dense(drawn),
    )


def _is_dense(drawn: Curves) -> bool:
    return sum(map(len, drawn.values())) > MOST_VECTOR_POINTS


def _series(sweep: Sweep, drawn: Curves, cost: Callable[[StepPoint], float]) -> list[Series]:
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


LARGEST = Style("#D55E00", "circle", 5.0)
MEDIAN = Style("#0072B2", "square", 4.2, dash=DASHED)
CREEP = Style("#009E73", "diamond", 3.6, dash=DOTTED)

SMALLEST_CREEP = 1e-10
"""Likewise of creep: round-off over a period."""


def option_figure(number: int, curve: OptionCurve) -> Figure:
    """Draw a curve, the `number`-th of the report: errors, and beside them the creep if anything sticks."""
    axis = _option_axis(curve)
    values, every = list(curve.errors), list(curve.errors.values())
    largest = [max(own.size, SMALLEST_DB) for own in every]
    median = [max(own.median_db, SMALLEST_DB) for own in every]
    notes = [own.variant.title for own in every]
    hover = "%{text}\n%{y:.3g} dB"
    errors: list[Mark] = [
        Rule("y", WRONG_DB, LIMIT),
        Series(values, largest, LARGEST, "largest error", "lines+markers", hover, notes),
        Series(values, median, MEDIAN, "median error", "lines+markers", hover, notes),
    ]
    panels = [Panel(axis, Axis("error to truth [dB]", scale="log"), errors)]
    creep = [max(creep, SMALLEST_CREEP) for creep in curve.creep]  # NaN stays
    if any(each > SMALLEST_CREEP for each in creep):
        series = Series(values, creep, CREEP, "largest creep", "lines+markers", "%{text}\n%{y:.3g} ω U0", notes)
        panels.append(Panel(axis, Axis("creep within sticks / (ω U0) [-]", scale="log"), [series]))
    return Figure(
        f"option-{number}-{curve.option}",
        f"{curve.title}: error to the truth over {curve.option}, all else equal; dashed: {ratio(WRONG_DB)} dB, from "
        "which on a variant is wrong",
        panels,
        height=2.2 * len(panels) + 0.5,
        pixels=250 * len(panels) + 60,
        legend_columns=3,
        dense=True,
    )


def _option_axis(curve: OptionCurve) -> Axis:
    """Give the axis of an option: by powers where its values span a decade; to scale about zero."""
    sizes = [abs(value) for value in curve.errors if value]
    ticks = {value: ratio(value) for value in curve.errors}
    if max(sizes) < 10 * min(sizes):
        return Axis(curve.option, ticks=ticks)
    if min(curve.errors) > 0:
        return Axis(curve.option, scale="log", ticks=ticks)
    return Axis(curve.option, scale="asinh", linear=min(sizes), ticks=ticks)
