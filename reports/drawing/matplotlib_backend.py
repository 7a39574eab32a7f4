"""Figures for print, by matplotlib: SVG, PDF and pictures of pixels."""

import io
import re
from typing import Any, Literal

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_pdf import FigureCanvasPdf
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.collections import PolyCollection, QuadMesh
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure as Canvas
from PIL import Image

from reports.drawing.figure import Axis, Bars, Figure, HeatMap, Mark, Panel, Rule, Series
from reports.drawing.style import Style
from reports.formatting import ratio

COLUMN = 3.5
"""Width of one column of a journal [inch]."""

PAGE_WIDTH = 7.2
"""Width of two columns with the gap between them [inch]."""

PIXELS = 150
"""Dots an inch of pictures of pixels."""

CANVASES = {"png": FigureCanvasAgg, "svg": FigureCanvasSVG, "pdf": FigureCanvasPdf}
"""What draws a figure into a file, by its ending."""

SLANTED = 4
"""Written ticks below a panel beyond which they are slanted, not to overlap."""

CAPS = 2.0
"""Half the width of the caps of error bars, over that of the bars."""

COLOURS = "cividis"
"""Of maps, even in lightness: read alike in colour, by colour-blind readers, and in grey."""

PRINT_STYLE: dict[Any, Any] = {
    **dict.fromkeys(("font.size", "axes.titlesize", "axes.labelsize", "figure.labelsize"), 8.0),
    **dict.fromkeys(("legend.fontsize", "legend.title_fontsize", "xtick.labelsize", "ytick.labelsize"), 7.0),
    "axes.titlepad": 3.0,
    "legend.columnspacing": 1.0,
    "lines.linewidth": 1.1,
    **dict.fromkeys(("axes.linewidth", "xtick.major.width", "ytick.major.width"), 0.6),
    "axes.grid": True,
    "grid.color": "0.88",
    "grid.linewidth": 0.5,
    "axes.axisbelow": True,
    **dict.fromkeys(("axes.spines.top", "axes.spines.right", "legend.frameon"), False),
    "savefig.dpi": 300.0,
    "svg.fonttype": "path",
    "svg.hashsalt": "multibody-xval",
    "pdf.fonttype": 42,
}
"""Style of printed figures: 8 points in a column's width, thin lines, outlined text."""

_MARKERS = {
    "circle": "o", "square": "s", "triangle-up": "^", "diamond": "D", "triangle-down": "v", "cross": "P", "x": "X",
    "star": "*", "x-thin": "x", "cross-thin": "+", "dot": "o", "line-ns": "|",
}  # fmt: skip


def print_files(figure: Figure) -> dict[str, bytes]:
    """Draw once; give the figure as SVG and as PDF, by ending, and as PNG if it is dense."""
    with mpl.rc_context(PRINT_STYLE):
        canvas = drawn(figure)
        files, resolution = {}, canvas.dpi
        _lay_out(canvas, PIXELS if figure.dense else resolution)
        if figure.dense:
            files["png"] = _few_colours(_saved(canvas, "png", {"Software": None}, PIXELS))
        svg = _saved(canvas, "svg", dict.fromkeys(("Creator", "Date", "Format", "Type")), resolution)
        files["svg"] = b"\n".join(map(bytes.strip, svg.splitlines()))  # a tenth of it is indentation
        files["pdf"] = _saved(canvas, "pdf", dict.fromkeys(("Creator", "Producer", "CreationDate")), resolution)
        return files


def drawn(figure: Figure) -> Canvas:
    """Draw a figure in the style that matplotlib is set to."""
    canvas = Canvas(figsize=(PAGE_WIDTH if figure.wide else COLUMN, figure.height), layout="constrained")
    side_by_side = figure.columns > 1
    grid = canvas.subplots(
        figure.rows, figure.columns, squeeze=False, sharex=not side_by_side, sharey=side_by_side,
        height_ratios=figure.heights or None,
    ).ravel()  # fmt: skip
    for axes, panel in zip(grid, figure.panels, strict=False):
        _draw_panel(axes, panel, figure.dense)
    for axes in grid[len(figure.panels) :]:
        axes.set_visible(False)
    _draw_colour_scale(canvas, list(grid[: len(figure.panels)]), figure)
    canvas.supxlabel(mathtext(figure.x_label))
    canvas.supylabel(mathtext(figure.y_label))
    if figure.legend_columns:
        every = [pair for axes in grid for pair in zip(*axes.get_legend_handles_labels(), strict=True)]
        named = {name: handle for handle, name in reversed(every)}
        order = dict.fromkeys(name for _, name in every)
        canvas.legend(
            [named[name] for name in order], order, loc="outside upper center", ncols=figure.legend_columns,
            title=mathtext(figure.legend_title),
        )  # fmt: skip
    return canvas


def _draw_colour_scale(canvas: Canvas, every: list[Axes], figure: Figure) -> None:
    """Draw the scale of the first map beside all panels, if there is a map."""
    maps = [mark for panel in figure.panels for mark in panel.marks if isinstance(mark, HeatMap)]
    meshes = [mesh for axes in every for mesh in axes.collections if isinstance(mesh, QuadMesh)]
    if not maps:
        return
    scale = canvas.colorbar(meshes[0], ax=every, label=mathtext(maps[0].label), extend="both")
    if maps[0].scale == "log":
        scale.set_ticks(maps[0].decades, labels=list(map(ratio, maps[0].decades)))


def mathtext(label: str) -> str:
    """Set symbols with an index as matplotlib's mathematics: η_r, μλ̃_N."""

    def symbol(match: re.Match[str]) -> str:
        return "$" + re.sub("(.)\u0303", r"\\tilde{\1}", match[0]) + "$"

    return re.sub("[\\w/\u0303]+_\\w", symbol, label)


def _draw_panel(axes: Axes, panel: Panel, dense: bool) -> None:
    _set_axis(axes, "x", panel.x)
    _set_axis(axes, "y", panel.y)
    for depth, mark in enumerate(panel.marks):
        _draw(axes, mark, dense, 2 + depth / len(panel.marks))
    axes.set_title(panel.title)
    if panel.names_at_right:
        right = axes.twinx()
        right.set_ylim(axes.get_ylim())
        right.set_yticks(list(panel.names_at_right), list(panel.names_at_right.values()), fontsize=4.6)
        right.tick_params(length=0, pad=2)
        right.grid(visible=False)
        right.spines[:].set_visible(False)


def _set_axis(axes: Axes, which: Literal["x", "y"], axis: Axis) -> None:
    options = {"linear_width": axis.linear} if axis.scale == "asinh" else {}
    getattr(axes, f"set_{which}scale")(axis.scale, **options)
    axes.set(**{f"{which}label": mathtext(axis.label)})
    if not axis.grid:
        axes.grid(axis=which, visible=False)
    if axis.most_ticks:
        axes.locator_params(axis=which, nbins=axis.most_ticks)
    if axis.ticks is not None:
        set_ticks = getattr(axes, f"set_{which}ticks")
        set_ticks([], minor=True)
        set_ticks(list(axis.ticks), list(axis.ticks.values()))
        if which == "x" and len(axis.ticks) > SLANTED:
            axes.tick_params(axis="x", labelrotation=30)
    if axis.range is not None:
        axes.set(**{f"{which}lim": axis.range})


def _draw(axes: Axes, mark: Mark, dense: bool, depth: float) -> None:
    match mark:
        case Series():
            _draw_series(axes, mark, dense, depth)
        case Bars():
            axes.add_collection(
                PolyCollection(_corners(mark), facecolors=mark.colour, linewidths=0, label=mark.name, zorder=depth)
            )
        case HeatMap():
            norm = (LogNorm if mark.scale == "log" else Normalize)(mark.low, mark.high)
            axes.pcolormesh(mark.x, mark.y, mark.z, cmap=COLOURS, norm=norm, shading="nearest", rasterized=True)
        case Rule():
            across = axes.axvline if mark.axis == "x" else axes.axhline
            across(mark.at, color=mark.style.colour, linewidth=mark.style.width, linestyle=_line(mark.style))


def _draw_series(axes: Axes, mark: Series, dense: bool, depth: float) -> None:
    style, x, y = mark.style, np.asarray(mark.x, dtype=float), np.asarray(mark.y, dtype=float)
    dot = style.symbol == "dot"
    axes.errorbar(
        x, y, xerr=mark.x_error, elinewidth=style.width, capsize=CAPS * style.width,
        color=style.colour, linewidth=style.width, linestyle=_line(style) if "lines" in mark.draw else "none",
        marker=_MARKERS[style.symbol] if "markers" in mark.draw else "none", markersize=style.size,
        markerfacecolor=style.colour if dot else "none", markeredgewidth=0.0 if dot else 0.8,
        label=mark.name or None, zorder=depth, rasterized=dense and mark.draw == "markers",
    )  # fmt: skip


def _line(style: Style) -> Any:
    return (0, style.dash) if style.dash else "-"


def _corners(bars: Bars) -> Any:
    """Give the corners of bars, shape (bars, 4, 2)."""
    left, middle, half = np.array(bars.start), np.array(bars.middle), bars.height / 2
    right = left + bars.length
    x = np.array([left, left, right, right])
    y = np.array([middle - half, middle + half, middle + half, middle - half])
    return np.stack([x, y]).T


def _lay_out(canvas: Canvas, resolution: float) -> None:
    """Lay a figure out at so many dots an inch; no file needs it again."""
    canvas.dpi = resolution
    layout = canvas.get_layout_engine()
    if layout is not None:
        layout.execute(canvas)
        canvas.set_layout_engine("none")


def _saved(canvas: Canvas, ending: str, metadata: dict[str, Any], resolution: float) -> bytes:
    """Draw a figure that is laid out into a file, once: `Figure.savefig` draws it twice."""
    canvas.dpi = resolution  # each file sets its own
    file = io.BytesIO()
    getattr(CANVASES[ending](canvas), f"print_{ending}")(file, metadata=metadata)
    return file.getvalue()


def _few_colours(png: bytes) -> bytes:
    """Give a picture with a palette of its own: a fraction of its bytes, without visible loss in lines and markers."""
    file = io.BytesIO()
    Image.open(io.BytesIO(png)).convert("RGB").quantize(64).save(file, "png", optimize=True)
    return file.getvalue()
