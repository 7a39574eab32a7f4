"""A scale that is linear near zero and logarithmic far from it, for differences with a sign."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter

from reports.figures.figure import axis, rounded
from reports.formatting import ratio


def signed_ticks(positive: Sequence[float], limit: float) -> list[float]:
    """Give zero and, on both sides, the ticks within the limit."""
    inside = [tick for tick in positive if tick <= limit]
    return [*(-tick for tick in reversed(inside)), 0.0, *inside]


def print_scale(axes: Axes, which: str, linear: float, ticks: Sequence[float], limit: float) -> None:
    """Scale the axis `which` (x or y) of a printed figure: linear as far as `linear`."""
    getattr(axes, f"set_{which}scale")("asinh", linear_width=linear)
    getattr(axes, f"set_{which}lim")(-limit, limit)
    getattr(axes, f"set_{which}ticks")(signed_ticks(ticks, limit))
    getattr(axes, f"set_{which}ticks")([], minor=True)
    getattr(axes, f"{which}axis").set_major_formatter(FuncFormatter(lambda value, _: ratio(value)))


def stretched(values: Iterable[float], linear: float) -> list[float | None]:
    """Give differences as plotly draws them, which has no such scale: as asinh(value / linear)."""
    return rounded(np.arcsinh(np.fromiter(values, dtype=np.float64) / linear), 5)


def plot_scale(title: str, linear: float, ticks: Sequence[float], limit: float, **more: Any) -> dict[str, Any]:
    """Give the axis of plotly to values of `stretched`, with the true values at its ticks."""
    shown = signed_ticks(ticks, limit)
    end = float(np.arcsinh(limit / linear))
    return axis(
        title,
        range=[-end, end],
        tickmode="array",
        tickvals=stretched(shown, linear),
        ticktext=[ratio(tick) for tick in shown],
        **more,
    )
