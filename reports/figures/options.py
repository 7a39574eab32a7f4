"""The error over the value of one option."""

from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reports.figures.drawing import Drawing, legend, set_ticks
from reports.figures.errors import LIMIT, SMALLEST_DB
from reports.figures.style import COLUMN, PRINT_STYLE
from reports.formatting import ratio
from scenarios.sweeps.truths import WRONG_DB

LINES: dict[str, dict[str, Any]] = {
    "largest_error_db": {"color": "#D55E00", "marker": "o"},
    "median_error_db": {"color": "#0072B2", "marker": "s", "linestyle": "--"},
    "largest_creep": {"color": "#009E73", "marker": "D", "linestyle": ":"},
}
"""How the columns of a curve are drawn."""

SMALLEST_CREEP = 1e-10
"""Creep below is drawn here: round-off over a period."""


@mpl.rc_context(PRINT_STYLE)
def option_figure(number: int, curve: pd.DataFrame) -> Drawing:
    """Draw a curve, the `number`-th of the report: errors, and below them the creep if anything sticks."""
    title, option = curve["curve"][0], curve["option"][0]
    creeps = bool((curve["largest_creep"] > SMALLEST_CREEP).any())
    canvas = Figure(figsize=(COLUMN, 4.9 if creeps else 2.7), layout="constrained")
    upper, *lower = canvas.subplots(1 + creeps, squeeze=False).ravel()
    upper.axhline(WRONG_DB, **LIMIT)
    _draw(upper, curve, ["largest_error_db", "median_error_db"], SMALLEST_DB, "error to truth [dB]")
    for axes in lower:
        _draw(axes, curve, ["largest_creep"], SMALLEST_CREEP, "creep within sticks / (ω U0) [-]")
    canvas.axes[-1].set_xlabel(option)
    legend(canvas, 3)
    caption = (
        f"{title}: error to the truth over {option}, all else equal; dashed: {ratio(WRONG_DB)} dB, from "
        "which on a variant is wrong"
    )
    return Drawing(f"option-{number}-{option}", caption, canvas)


def _draw(axes: Axes, curve: pd.DataFrame, columns: Sequence[str], smallest: float, label: str) -> None:
    for column in columns:
        name = column.replace("_error_db", " error").replace("_", " ")
        axes.plot(curve["value"], curve[column].clip(lower=smallest), label=name, markersize=4.0, **LINES[column])
    axes.set(yscale="log", ylabel=label)
    _set_option_axis(axes, list(curve["value"]))


def _set_option_axis(axes: Axes, values: Sequence[float]) -> None:
    """Scale the axis of an option: by powers where its values span a decade; to scale about zero."""
    sizes = [abs(value) for value in values if value]
    if max(sizes) >= 10 * min(sizes):
        if min(values) > 0:
            axes.set_xscale("log")
        else:
            axes.set_xscale("asinh", linear_width=min(sizes))
    set_ticks(axes, "x", {value: ratio(value) for value in values})
