"""A figure of a report, its files, and many small panels in one figure."""

import io
import re
import textwrap
import zlib
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_pdf import FigureCanvasPdf
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from multibody_xval.reports.figures.style import BLANK, LINE, PAGE_WIDTH, PRINT_STYLE
from multibody_xval.reports.formatting import ratio

CANVASES = {
    "svg": (FigureCanvasSVG, ("Creator", "Date", "Format", "Type")),
    "pdf": (FigureCanvasPdf, ("Creator", "Producer", "CreationDate")),
    "png": (FigureCanvasAgg, ("Software",)),
}
"""By ending of a file, what draws into it, and what it would say about its making."""

PIXELS = 150
"""Dots an inch of maps and of pictures of pixels."""

LETTER = 0.0615
"""Width of a letter of a panel's title [inch], on average."""

TITLE, LEGEND, BELOW = 0.13, 0.28, 0.5
"""Height of a line of a panel's title, of the legend, and of ticks and label below all panels [inch]."""


@dataclass(frozen=True)
class Drawing:
    """A figure that is drawn."""

    name: str
    """Name of its files, without the ending; unique in a report."""
    caption: str
    canvas: Figure

    @property
    def width(self) -> float:
        """In print [pt]."""
        return 72 * float(self.canvas.get_figwidth())

    def file(self, ending: str) -> bytes:
        """Draw it into a file of this format, once: `Figure.savefig` draws twice."""
        draws, without = CANVASES[ending]
        file = io.BytesIO()
        self.canvas.dpi = PIXELS
        with mpl.rc_context({**PRINT_STYLE, "svg.fonttype": "none", "svg.hashsalt": self.name}):
            getattr(draws(self.canvas), f"print_{ending}")(file, metadata=dict.fromkeys(without))
        return _smaller(file.getvalue().decode(), self.name).encode() if ending == "svg" else file.getvalue()


def _smaller(svg: str, name: str) -> str:
    """Round coordinates to a hundredth of a point, name styles once, and leave out what nothing needs."""
    svg = re.sub(r'="[^"]*"', lambda value: re.sub(r"\d+\.\d{3,}", _hundredths, value[0]), svg)
    used = set(re.findall(r"[\"(]#([^\")]+)[\")]", svg))
    svg = re.sub(r' id="([^"]+)"', lambda match: match[0] if match[1] in used else "", svg)
    svg = re.sub(r' transform="rotate\(-0 [^"]*"', "", svg)
    counts, prefix = Counter(re.findall(r' style="([^"]*)"', svg)), f"f{zlib.crc32(name.encode()):x}-"
    classes = {style: f"{prefix}{k}" for k, (style, count) in enumerate(counts.items()) if count > 2}
    svg = re.sub(r' style="([^"]*)"', lambda own: f' class="{classes[own[1]]}"' if own[1] in classes else own[0], svg)
    rules = "".join(f".{own}{{{style}}}" for style, own in classes.items())
    return "\n".join(filter(None, map(str.strip, svg.replace("</style>", f"{rules}</style>", 1).splitlines())))


def _hundredths(number: re.Match[str]) -> str:
    return f"{float(number[0]):.2f}".rstrip("0").rstrip(".")


def small_multiples(
    titles: Sequence[str],
    height: float,
    *,
    columns: int = 4,
    parts: Sequence[float] = (1.0,),
    left: float = 0.55,
    x_label: str = "",
    y_labels: Sequence[str] = ("",),
) -> tuple[Figure, list[list[Axes]]]:
    """Give a figure with small panels in rows, as many axes each as `parts` of its `height` [inch] say.

    Only the left panels name the values of y, and the lowest ones those of x: all have the same limits, which are set
    by who draws in them.
    """
    columns = min(columns, max(len(titles), 2))
    rows = -(-len(titles) // columns)
    pitch = (PAGE_WIDTH - left) / columns
    wrapped = [textwrap.fill(title, int((pitch - 0.1) / LETTER)) for title in titles]
    above = 0.08 + TITLE * max(title.count("\n") + 1 for title in wrapped)
    whole = LEGEND + rows * (above + height) + BELOW
    canvas = Figure(figsize=(PAGE_WIDTH, whole))
    panels = []
    for k, title in enumerate(wrapped):
        row, column = divmod(k, columns)
        corner = (left + column * pitch, whole - LEGEND - row * (above + height) - above)
        own = _stacked(canvas, corner, pitch - 0.12, [height * part / sum(parts) for part in parts])
        for axes, label in zip(own, y_labels, strict=True):
            axes.tick_params(labelsize=6.0, length=2.0, pad=2.0, labelleft=column == 0, labelbottom=False)
            axes.set_ylabel(label if column == 0 and len(parts) > 1 else "", fontsize=7.0)
        own[0].set_title(title, fontsize=7.0, loc="left")
        own[-1].tick_params(labelbottom=k + columns >= len(titles))
        panels.append(own)
    canvas.text(0.5, 0.07 / whole, mathtext(x_label), ha="center", va="bottom", fontsize=7.5)
    if len(parts) == 1:
        middle = (BELOW + whole - LEGEND) / 2 / whole
        canvas.text(0.01, middle, mathtext(y_labels[0]), ha="left", va="center", rotation="vertical", fontsize=7.5)
    return canvas, panels


def _stacked(canvas: Figure, corner: tuple[float, float], width: float, heights: Sequence[float]) -> list[Axes]:
    """Give axes below each other, from the upper left corner on [inch]."""
    left, top = corner
    gap = 0.07 if len(heights) > 1 else 0.0
    stacked = []
    for height in heights:
        stacked.append(canvas.add_axes(place_of((left, top - height, width, height - gap), canvas)))
        top -= height
    return stacked


def place_of(inches: Sequence[float], canvas: Figure) -> tuple[float, float, float, float]:
    """Give left and lower end, width and height of axes as parts of the figure."""
    left, low, width, height = np.array(inches) / np.tile(canvas.get_size_inches(), 2)
    return float(left), float(low), float(width), float(height)


def legend(canvas: Figure, columns: int = 6, **options: Any) -> None:
    """Name everything that has a label, once for all panels, above them."""
    every = [pair for axes in canvas.axes for pair in zip(*axes.get_legend_handles_labels(), strict=True)]
    named = {name: handle for handle, name in reversed(every)}
    order = dict.fromkeys(name for _, name in every)
    constrained = canvas.get_layout_engine() is not None
    canvas.legend(
        [named[name] for name in order], order, ncols=min(len(order), columns) or 1,
        **{"loc": "outside upper center" if constrained else "upper center", **options},
    )  # fmt: skip


def mathtext(label: str) -> str:
    """Set symbols with an index as matplotlib's mathematics: η_r, μλ̃_N."""

    def symbol(match: re.Match[str]) -> str:
        return "$" + re.sub("(.)\u0303", r"\\tilde{\1}", match[0]) + "$"

    return re.sub("[\\w/\u0303]+_\\w", symbol, label)


def set_difference_axis(axes: Axes, which: str, linear: float, ticks: Iterable[float], limit: float) -> None:
    """Let an axis go from ``-limit`` to `limit`: to scale up to `linear`, by the logarithm beyond."""
    inside = [tick for tick in ticks if tick <= limit]
    shown = [*(-tick for tick in reversed(inside)), 0.0, *inside]
    getattr(axes, f"set_{which}scale")("asinh", linear_width=linear)
    set_ticks(axes, which, {tick: ratio(tick) for tick in shown})
    axes.set(**{f"{which}lim": (-limit, limit)})


def set_ticks(axes: Axes, which: str, texts: dict[float, str], **options: Any) -> None:
    """Put these texts at these values, and no other ticks."""
    set_own = getattr(axes, f"set_{which}ticks")
    set_own([], minor=True)
    set_own(list(texts), list(texts.values()), **options)


def hatched(axes: Axes) -> None:
    """Hatch what a map leaves blank, which no colour could show."""
    axes.grid(visible=False)
    axes.patch.set(facecolor=BLANK, hatch="//////", edgecolor=LINE, linewidth=0.0)
