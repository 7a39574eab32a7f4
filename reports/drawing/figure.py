"""Figures as data: panels with axes and marks; `matplotlib_backend` and `plotly_backend` draw it.

Labels and hover texts write an index as ``η_r``. Hover texts name the numbers of a point as plotly does, with a format
of d3: ``%{x}``, ``%{y:.3f}``, and ``%{text}`` for its note; they break lines where the text does.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from numpy.typing import ArrayLike

from reference_lcp.validation import FloatArray
from reports.drawing.style import Style
from reports.formatting import ratio

Draw = Literal["lines", "markers", "lines+markers"]


@dataclass(frozen=True)
class Axis:
    """An axis of a panel."""

    label: str = ""
    range: tuple[float, float] | None = None
    """Both ends, the first at the left or at the bottom; as the marks need if ``None``."""
    scale: Literal["linear", "log", "asinh"] = "linear"
    """``asinh`` is for differences with a sign: to scale up to `linear`, by their logarithm beyond."""
    linear: float = 1.0
    ticks: Mapping[float, str] | None = None
    """Text by value; the backend's own choice if ``None``."""
    most_ticks: int = 0
    """How many the backend may choose; 0: as many as it likes."""
    decimals: int = 4
    """Digits after the point that the page holds; an axis with a logarithm has as many that count."""
    grid: bool = True


def difference_axis(label: str, linear: float, ticks: Sequence[float], limit: float, decimals: int = 5) -> Axis:
    """Give an axis from ``-limit`` to `limit`, to scale up to `linear`, with `ticks` on both sides of zero."""
    inside = [tick for tick in ticks if tick <= limit]
    shown = [*(-tick for tick in reversed(inside)), 0.0, *inside]
    return Axis(label, (-limit, limit), "asinh", linear, {tick: ratio(tick) for tick in shown}, decimals=decimals)


@dataclass(frozen=True)
class Series:
    """Points, joined by a line or not; NaN is a gap."""

    x: ArrayLike
    y: ArrayLike
    """Values, shape (points,)."""
    style: Style
    name: str = ""
    """In the legend, once for all series of that name, which are shown and hidden together; none without."""
    draw: Draw = "lines"
    hover: str = ""
    notes: Sequence[str] = ()
    """Text at the pointer, see the module, and the text of each point in it; nothing without."""
    x_error: ArrayLike | None = None
    """Half the length of horizontal error bars, as wide as the line would be."""


@dataclass(frozen=True)
class Bars:
    """Horizontal bars of one height and colour: where each starts, how long it is, where its middle is in y."""

    start: Sequence[float]
    length: Sequence[float]
    middle: Sequence[float]
    height: float
    colour: str
    name: str
    notes: Sequence[str]


@dataclass(frozen=True)
class HeatMap:
    """Values in colours; the scale of the first one of a figure is shown, and is that of all others."""

    x: FloatArray
    y: FloatArray
    z: FloatArray
    """Middles of the columns and rows, and values, shape (y, x); NaN is blank."""
    low: float
    high: float
    label: str
    hover: str
    scale: Literal["linear", "log"] = "linear"
    """``log``: colours are even in the logarithm, and `z` is positive."""
    notes: Sequence[Sequence[str]] = ()

    @property
    def decades(self) -> list[float]:
        """Powers of ten on a scale of logarithms."""
        first, last = round(math.log10(self.low)), round(math.log10(self.high))
        return [float(f"1e{power}") for power in range(first, last + 1)]


@dataclass(frozen=True)
class Rule:
    """A line across the panel where `axis` has the value `at`."""

    axis: Literal["x", "y"]
    at: float
    style: Style


Mark = Series | Bars | HeatMap | Rule


@dataclass(frozen=True)
class Panel:
    """Marks between two axes; later ones are drawn above earlier ones."""

    x: Axis
    y: Axis
    marks: Sequence[Mark]
    title: str = ""
    """Above the panel in print, below it on the page."""
    names_at_right: Mapping[float, str] | None = None
    """Text by value of y; left out on narrow screens."""


@dataclass(frozen=True)
class Figure:
    """One figure."""

    name: str
    """Name of its files, without the ending, and its identifier in the page; unique in a report."""
    caption: str
    panels: Sequence[Panel]
    """Row by row. Panels below each other in one column share x, side by side share y."""
    height: float
    pixels: int
    """In print [inch], and on the page without its legend."""
    columns: int = 1
    heights: Sequence[float] = ()
    """Panels in a row, and heights of the rows over each other; equal if not given."""
    legend_columns: int = 2
    legend_title: str = ""
    """Of the printed legend; 0: there is none, nor on the page."""
    x_label: str = ""
    y_label: str = ""
    """What all panels share, in print."""
    wide: bool = False
    """As wide as two columns of a journal, and the whole width of the page."""
    dense: bool = False
    """It holds so much that the page has a still picture of pixels of it, which is smaller than the drawing, and that
    points are pixels in print too.
    """
    together: bool = False
    """The pointer tells the values of all series at its x on the page, and not of the nearest point alone."""

    @property
    def rows(self) -> int:
        """Rows of panels."""
        return -(-len(self.panels) // self.columns)
