"""Figures for the screen, by plotly: ``data`` and ``layout``, as numbers and texts that JSON holds."""

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from reports.drawing.figure import Axis, Bars, Figure, HeatMap, Panel, Rule, Series
from reports.drawing.style import Style
from reports.formatting import ratio, typeset

PIXELS_A_POINT = 1.6
"""Sizes and widths on the page over those in print."""

DASHES = 1.7
"""Dashes on the page [px] over those in print, in widths of the line."""

COLOURS = "Cividis"
"""As in print."""

BELOW_A_PANEL = 62
"""Room for ticks and title below a panel of several side by side [px]."""

MOST_GAP = 0.6
"""Part of its height that this is at most."""

BESIDE_A_PANEL = 170
"""Room for names at the right of a panel [px]."""

PANEL_GAP = 0.07
"""Between panels below each other, over the height of all."""

_AXIS = {
    "gridcolor": "#e3e6ea",
    "zeroline": False,
    "linecolor": "#57606a",
    "ticks": "outside",
    "tickcolor": "#57606a",
    "automargin": True,
}
_LAYOUT: dict[str, Any] = {
    "margin": {"l": 60, "r": 16, "t": 10, "b": 48},
    "font": {"family": "system-ui, Segoe UI, Liberation Sans, Arial, sans-serif", "size": 13, "color": "#1b1f24"},
    "plot_bgcolor": "#fff",
    "paper_bgcolor": "#fff",
    "hovermode": "closest",
    "hoverlabel": {"namelength": -1},
    "barmode": "overlay",
}
_LEGEND = {
    "orientation": "h", "x": 0, "xanchor": "left", "y": 1, "yanchor": "top", "yref": "container", "tracegroupgap": 0,
}  # fmt: skip


def plot(figure: Figure) -> dict[str, Any]:
    """Give the figure of plotly: its ``data`` and its ``layout``."""
    data: list[dict[str, Any]] = []
    shapes: list[dict[str, Any]] = []
    for k, panel in enumerate(figure.panels):
        x, y = _number(0 if figure.columns == 1 else k), _number(k)
        for mark in panel.marks:
            if isinstance(mark, Rule):
                shapes.append(_shape(mark, panel, f"x{x}", f"y{y}"))
            else:
                data.append(_trace(mark, panel) | {"xaxis": f"x{x}", "yaxis": f"y{y}"})
    _name_once(data, bool(figure.legend_columns))
    for trace in [trace for trace in data if trace["type"] == "heatmap"][1:]:
        trace["showscale"] = False
        del trace["colorbar"]
    legend = dict(_LEGEND)
    if figure.legend_title:
        legend["title"] = {"text": _text(figure.legend_title), "font": {"size": 13}}
    layout = _LAYOUT | {"height": figure.pixels, "legend": legend, "shapes": shapes} | _axes(figure)
    if figure.together:
        layout |= {"hovermode": "x unified"}
    names = figure.panels[0].names_at_right if len(figure.panels) == 1 else None
    if names:
        layout["margin"] = _LAYOUT["margin"] | {"r": BESIDE_A_PANEL}
        layout["annotations"] = [_name_at_right(text, place) for place, text in names.items()]
    return {"data": data, "layout": layout}


def _name_at_right(text: str, y: float) -> dict[str, Any]:
    return {
        "text": text, "x": 1, "xref": "paper", "xanchor": "left", "y": round(y, 4), "yanchor": "middle",
        "showarrow": False, "font": {"size": 8},
    }  # fmt: skip


def _number(k: int) -> str:
    """Give what plotly's name of the k-th axis, from 0, ends in."""
    return str(k + 1) if k else ""


def _text(label: str) -> str:
    return str(typeset(label)).replace("\n", "<br>")


def _name_once(data: list[dict[str, Any]], legend: bool) -> None:
    """Leave one entry in the legend for all traces of a name; it shows and hides them together."""
    known: set[str] = set()
    for trace in data:
        name = trace.get("name", "")
        trace["showlegend"] = legend and bool(name) and name not in known
        if name:
            trace["legendgroup"] = name
        known.add(name)


def _axes(figure: Figure) -> dict[str, Any]:
    """Give all axes: panels below each other share the x of the last, panels side by side the y of the first."""
    axes: dict[str, Any] = {}
    for k, panel in enumerate(figure.panels):
        axes[f"yaxis{_number(k)}"] = _axis(panel.y, panel.y.label)
        axes[f"xaxis{_number(k)}"] = _axis(panel.x, panel.x.label or panel.title)
    if figure.columns > 1:
        _name_shared(axes, figure)
        gap = min(BELOW_A_PANEL * figure.rows / figure.pixels, MOST_GAP)
        grid = {"rows": figure.rows, "columns": figure.columns, "pattern": "independent", "xgap": 0.12, "ygap": gap}
        for k in range(1, len(figure.panels)):
            axes[f"yaxis{k + 1}"] |= {"matches": "y", "showticklabels": k % figure.columns == 0}
        return axes | {"grid": grid}
    last = _number(figure.rows - 1)
    shares = np.array(figure.heights or [1.0] * figure.rows)
    heights = shares / shares.sum() * (1 - PANEL_GAP * (figure.rows - 1))
    top = 1.0
    for k, height in enumerate(heights.tolist()):
        axes[f"yaxis{_number(k)}"]["domain"] = [round(max(top - height, 0.0), 4), round(top, 4)]
        top -= height + PANEL_GAP
    shared = axes[f"xaxis{last}"] | {"anchor": f"y{last}"}
    return {name: axis for name, axis in axes.items() if name.startswith("y")} | {"xaxis": shared}


def _name_shared(axes: dict[str, Any], figure: Figure) -> None:
    """Write what all panels share at the first of every row, and below the last of every column."""
    for k in range(len(figure.panels)):
        title = axes[f"xaxis{_number(k)}"]["title"]
        if k + figure.columns >= len(figure.panels):
            title["text"] = "<br>".join(text for text in (title["text"], _text(figure.x_label)) if text)
        if k % figure.columns == 0 and figure.y_label:
            axes[f"yaxis{_number(k)}"]["title"]["text"] = _text(figure.y_label)


def _axis(axis: Axis, title: str) -> dict[str, Any]:
    given: dict[str, Any] = {"title": {"text": _text(title), "standoff": 8}, "showgrid": axis.grid}
    if axis.scale == "log":
        given |= {"type": "log", "exponentformat": "power", "dtick": 1, "tickangle": 0}
    if axis.range is not None:
        ends = np.log10(axis.range) if axis.scale == "log" else _position(axis, axis.range)
        given["range"] = [float(end) for end in ends]
    if axis.most_ticks:
        given["nticks"] = axis.most_ticks
    if axis.ticks is not None:
        ticks = {"tickvals": _numbers(axis, list(axis.ticks)), "ticktext": list(axis.ticks.values())}
        given |= {"tickmode": "array", **ticks}
    return _AXIS | given


def _position(axis: Axis, values: ArrayLike) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Give values as plotly draws them, which has no scale of asinh."""
    given = np.asarray(values, dtype=np.float64)
    return np.arcsinh(given / axis.linear) if axis.scale == "asinh" else given


def _numbers(axis: Axis, values: ArrayLike) -> list[float | None]:
    """Give values as the page holds them: rounded; ``None`` for NaN."""
    if axis.scale == "log":
        return [float(f"{value:.{axis.decimals}g}") if math.isfinite(value) else None for value in np.asarray(values)]
    return _rounded(_position(axis, values), axis.decimals)


def _rounded(values: Iterable[float], decimals: int) -> list[float | None]:
    return [round(float(value), decimals) if math.isfinite(value) else None for value in values]


def _trace(mark: Series | Bars | HeatMap, panel: Panel) -> dict[str, Any]:
    match mark:
        case Series():
            return _series(mark, panel)
        case Bars():
            return _bars(mark, panel)
        case HeatMap():
            return _heat_map(mark, panel)


def _heat_map(mark: HeatMap, panel: Panel) -> dict[str, Any]:
    """Give the map; plotly has no scale of logarithms for colours, which are those of the logarithm then."""
    bar: dict[str, Any] = {"title": {"text": _text(mark.label), "side": "right"}, "thickness": 14}
    z, ends = mark.z, [mark.low, mark.high]
    if mark.scale == "log":
        z, ends = np.log10(mark.z), [math.log10(end) for end in ends]
        bar |= {"tickvals": [math.log10(tick) for tick in mark.decades], "ticktext": list(map(ratio, mark.decades))}
    return {
        "type": "heatmap", "x": _numbers(panel.x, mark.x), "y": _numbers(panel.y, mark.y),
        "z": [_rounded(row, 2) for row in z], "zmin": ends[0], "zmax": ends[1], "colorscale": COLOURS,
        "colorbar": bar, "hovertemplate": f"{_text(mark.hover)}<extra></extra>",
    } | ({"text": [list(row) for row in mark.notes]} if mark.notes else {})  # fmt: skip


def _series(mark: Series, panel: Panel) -> dict[str, Any]:
    trace: dict[str, Any] = {
        "type": "scatter", "mode": mark.draw, "name": mark.name,
        "x": _numbers(panel.x, mark.x), "y": _numbers(panel.y, mark.y),
    }  # fmt: skip
    if "lines" in mark.draw:
        trace["line"] = _line(mark.style)
    if "markers" in mark.draw:
        trace["marker"] = _marker(mark.style)
    if mark.x_error is not None:
        trace["error_x"] = _error_bars(mark, panel.x)
    return trace | _hover(mark, panel)


def _error_bars(mark: Series, axis: Axis) -> dict[str, Any]:
    x, error = np.asarray(mark.x, dtype=float), np.asarray(mark.x_error, dtype=float)
    low, middle, high = (_position(axis, value) for value in (x - error, x, x + error))
    lengths = {"array": _rounded(high - middle, 5), "arrayminus": _rounded(middle - low, 5), "symmetric": False}
    width = mark.style.width
    return {"color": mark.style.colour, "thickness": _pixels(width), "width": _pixels(2 * width), **lengths}


def _hover(mark: Series, panel: Panel) -> dict[str, Any]:
    """Give hover texts with true values, also on scaled axes."""
    if not mark.hover:
        return {"hoverinfo": "skip"}
    texts: dict[str, Any] = {"hovertemplate": _text(mark.hover)}
    if mark.notes:
        texts["text"] = [note.replace("\n", "<br>") for note in mark.notes]
    for which, axis, values in (("x", panel.x, mark.x), ("y", panel.y, mark.y)):
        if axis.scale == "asinh":
            texts["customdata"] = _rounded(np.asarray(values, dtype=float), axis.decimals)
            texts["hovertemplate"] = texts["hovertemplate"].replace(f"%{{{which}", "%{customdata")
    return texts


def _bars(mark: Bars, panel: Panel) -> dict[str, Any]:
    return {
        "type": "bar", "orientation": "h", "name": mark.name, "y": _numbers(panel.y, mark.middle),
        "base": _numbers(panel.x, mark.start), "x": _numbers(panel.x, mark.length), "width": round(mark.height, 4),
        "marker": {"color": mark.colour, "line": {"width": 0}}, "textposition": "none", "hovertemplate": "%{text}",
        "text": [note.replace("\n", "<br>") for note in mark.notes],
    }  # fmt: skip


def _shape(mark: Rule, panel: Panel, x: str, y: str) -> dict[str, Any]:
    """Draw a line across the panel, behind the traces."""
    along, over = ("x", "y") if mark.axis == "x" else ("y", "x")
    at = float(_position(panel.x if mark.axis == "x" else panel.y, mark.at))
    names = {"x": x, "y": y}
    return {
        "type": "line", f"{along}ref": names[along], f"{along}0": at, f"{along}1": at,
        f"{over}ref": f"{names[over]} domain", f"{over}0": 0, f"{over}1": 1,
        "line": _line(mark.style), "layer": "below",
    }  # fmt: skip


def _line(style: Style) -> dict[str, Any]:
    dash = ",".join(f"{DASHES * length:.0f}px" for length in style.dash) or "solid"
    return {"color": style.colour, "dash": dash, "width": _pixels(style.width)}


def _marker(style: Style) -> dict[str, Any]:
    filled = style.symbol == "dot" or style.symbol.endswith("-thin")
    symbol = {"dot": "circle"}.get(style.symbol, style.symbol) if filled else f"{style.symbol}-open"
    marker = {"color": style.colour, "symbol": symbol, "size": _pixels(style.size)}
    return marker if style.symbol == "dot" else marker | {"line": {"width": 1.5, "color": style.colour}}


def _pixels(points: float) -> float:
    return round(PIXELS_A_POINT * points, 1)
