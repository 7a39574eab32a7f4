"""Error to the truth, and creep within sticks, over the value of one option of an engine."""

from reports.data.option_curves import OptionCurve
from reports.drawing.figure import Axis, Figure, Mark, Panel, Rule, Series
from reports.drawing.style import DASHED, DOTTED, Style
from reports.formatting import ratio
from scenarios.verdicts.truth_error import WRONG_DB

LARGEST = Style("#D55E00", "circle", 5.0)
MEDIAN = Style("#0072B2", "square", 4.2, dash=DASHED)
CREEP = Style("#009E73", "diamond", 3.6, dash=DOTTED)
LIMIT = Style("#666666", dash=DASHED, width=0.7)

SMALLEST_DB = 1e-5
"""Errors below are drawn here: less than the steady states of engines repeat to."""

SMALLEST_CREEP = 1e-10
"""Likewise of creep: round-off over a period."""


def option_figure(number: int, curve: OptionCurve) -> Figure:
    """Draw a curve, the `number`-th of the report: errors, and beside them the creep if anything sticks."""
    axis = _option_axis(curve)
    values = [point.value for point in curve.points]
    largest = [max(point.errors.size, SMALLEST_DB) for point in curve.points]
    median = [max(point.errors.median, SMALLEST_DB) for point in curve.points]
    notes = [point.errors.variant.title for point in curve.points]
    hover = "%{text}\n%{y:.3g} dB"
    errors: list[Mark] = [
        Rule("y", WRONG_DB, LIMIT),
        Series(values, largest, LARGEST, "largest error", "lines+markers", hover, notes),
        Series(values, median, MEDIAN, "median error", "lines+markers", hover, notes),
    ]
    panels = [Panel(axis, Axis("error to truth [dB]", scale="log"), errors)]
    creep = [max(point.creep, SMALLEST_CREEP) for point in curve.points]  # NaN stays
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
    sizes = [abs(point.value) for point in curve.points if point.value]
    ticks = {point.value: ratio(point.value) for point in curve.points}
    if max(sizes) < 10 * min(sizes):
        return Axis(curve.option, ticks=ticks)
    if curve.points[0].value > 0:
        return Axis(curve.option, scale="log", ticks=ticks)
    return Axis(curve.option, scale="asinh", linear=min(sizes), ticks=ticks)
