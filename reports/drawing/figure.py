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


@dataclass(frozen=True)
class Axis:
    """An axis of a panel.

    Parameters
    ----------
    label
        With its unit.
    range
        Both ends, the first at the left or at the bottom; as the marks need if ``None``.
    scale
        ``asinh`` is for differences with a sign: to scale up to `linear`, by their logarithm beyond.
    ticks
        Text by value; the backend's own choice if ``None``.
    most_ticks
        How many the backend may choose; 0: as many as it likes.
    decimals
        Digits after the point that the page holds; an axis with a logarithm has as many that count.
    """

    label: str = ""
    range: tuple[float, float] | None = None
    scale: Literal["linear", "log", "asinh"] = "linear"
    linear: float = 1.0
    ticks: Mapping[float, str] | None = None
    most_ticks: int = 0
    decimals: int = 4
    grid: bool = True


def difference_axis(label: str, linear: float, ticks: Sequence[float], limit: float, decimals: int = 5) -> Axis:
    """Give an axis from ``-limit`` to `limit`, to scale up to `linear`, with `ticks` on both sides of zero."""
    inside = [tick for tick in ticks if tick <= limit]
    shown = [*(-tick for tick in reversed(inside)), 0.0, *inside]
    return Axis(label, (-limit, limit), "asinh", linear, {tick: ratio(tick) for tick in shown}, decimals=decimals)


@dataclass(frozen=True)
class Series:
    """Points, joined by a line or not; NaN is a gap.

    Parameters
    ----------
    x, y
        Values, shape (points,).
    style
        Colour, shape and line.
    name
        In the legend, once for all series of that name, which are shown and hidden together; none without.
    draw
        What is drawn of it.
    hover, notes
        Text at the pointer, see the module, and the text of each point in it; nothing without.
    x_error
        Half the length of horizontal error bars, as wide as the line would be.
    """

    x: ArrayLike
    y: ArrayLike
    style: Style
    name: str = ""
    draw: Literal["lines", "markers", "lines+markers"] = "lines"
    hover: str = ""
    notes: Sequence[str] = ()
    x_error: ArrayLike | None = None


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
    """Values in colours; the scale of the first one of a figure is shown, and is that of all others.

    Parameters
    ----------
    x, y, z
        Middles of the columns and rows, and values, shape (y, x); NaN is blank.
    low, high
        Ends of the colours.
    label
        Of the scale, with its unit.
    hover
        Text at the pointer, see the module.
    scale
        ``log``: colours are even in the logarithm, and `z` is positive.
    notes
        Text of each value in the hover text, shape (y, x).
    """

    x: FloatArray
    y: FloatArray
    z: FloatArray
    low: float
    high: float
    label: str
    hover: str
    scale: Literal["linear", "log"] = "linear"
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
    """Marks between two axes; later ones are drawn above earlier ones.

    Parameters
    ----------
    title
        Above the panel in print, below it on the page.
    names_at_right
        Text by value of y, in print, where there is no pointer.
    """

    x: Axis
    y: Axis
    marks: Sequence[Mark]
    title: str = ""
    names_at_right: Mapping[float, str] | None = None


@dataclass(frozen=True)
class Figure:
    """One figure.

    Parameters
    ----------
    name
        Name of its files, without the ending, and its identifier in the page; unique in a report.
    caption
        Content, in a sentence.
    panels
        Row by row. Panels below each other in one column share x, side by side share y.
    height, pixels
        In print [inch], and on the page without its legend.
    columns, heights
        Panels in a row, and heights of the rows over each other; equal if not given.
    legend_columns, legend_title
        Of the printed legend; 0: there is none, nor on the page.
    x_label, y_label
        What all panels share, in print.
    wide
        As wide as two columns of a journal, and the whole width of the page.
    dense
        It holds so much that the page has a still picture of pixels of it, which is smaller than the drawing, and that
        points are pixels in print too.
    together
        The pointer tells the values of all series at its x on the page, and not of the nearest point alone.
    """

    name: str
    caption: str
    panels: Sequence[Panel]
    height: float
    pixels: int
    columns: int = 1
    heights: Sequence[float] = ()
    legend_columns: int = 2
    legend_title: str = ""
    x_label: str = ""
    y_label: str = ""
    wide: bool = False
    dense: bool = False
    together: bool = False

    @property
    def rows(self) -> int:
        """Rows of panels."""
        return -(-len(self.panels) // self.columns)
