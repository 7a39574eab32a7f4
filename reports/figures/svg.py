"""Figures as elements of a page and as files: small panels, each an SVG that is read aloud, and one PDF of all."""

import io
import math
import re
import textwrap
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import matplotlib as mpl
from markupsafe import Markup, escape
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

STYLE: dict[Any, Any] = {
    "font.size": 8.0, "axes.titlesize": 8.0, "svg.fonttype": "none", "axes.titley": 1.02, "axes.spines.top": False,
    "axes.spines.right": False, "axes.grid": True, "grid.color": "#e3e7eb", "grid.linewidth": 0.6,
    "axes.axisbelow": True, "axes.linewidth": 0.6, "xtick.major.width": 0.6, "ytick.major.width": 0.6,
    "text.color": "#1b1f24", "axes.edgecolor": "#57606a", "axes.labelcolor": "#1b1f24", "xtick.color": "#57606a",
    "ytick.color": "#57606a", "xtick.labelcolor": "#1b1f24", "ytick.labelcolor": "#1b1f24",
    "font.sans-serif": ["DejaVu Sans", "Verdana", "Arial"], "svg.hashsalt": "multibody-xval",
}  # fmt: skip

INTERVALS = 4
"""Between ticks: panels are small, and every tick takes time."""

WIDTH, LETTERS, COLUMNS = 3.4, 48, 3
"""Of a panel [inch], of a line of its title, and panels in a row of a PDF."""

COUNTERS = re.compile(r' id="(?:figure|axes|patch|line2d|text|xtick|ytick|matplotlib\.axis|legend|PathCollection|'
                      r'PolyCollection|LineCollection)_\d+"')  # fmt: skip
"""Numbers of matplotlib's groups, which would stand on a page more than once."""

TAG, LONG_NUMBER = re.compile(r"<[^>]+>"), re.compile(r"\d+\.\d{3,}")

MARKS = re.compile(r'<g((?: clip-path="[^"]*")?)>((?:\s*<use [^>]*?style="([^"]*)"/>)+)')
"""Marks of one curve, each of which has the style of all."""


class Panel(NamedTuple):
    """A picture with a title, what it shows in a sentence, and how it is drawn."""

    title: str
    text: str
    draw: Callable[[Axes], None]
    height: float = 2.3
    """[inch]"""
    width: float = WIDTH


def svg(panel: Panel, name: str) -> Markup:
    """Give a panel as an element of a page; its identifiers begin with `name`."""
    with mpl.rc_context({**STYLE, "svg.hashsalt": name}):
        figure = _figure(panel.width, panel.height)
        _drawn(figure.subplots(), panel)
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    body = text.getvalue().partition("<svg")[2].partition(">")
    inner = COUNTERS.sub("", re.sub(r"<metadata>.*?</metadata>|<!--.*?-->", "", body[2], flags=re.DOTALL))
    size = f'viewBox="0 0 {panel.width * 72:g} {panel.height * 72:g}"'
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" role="img" {size} '
        f'aria-labelledby="{name}-title {name}-text"><title id="{name}-title">{escape(panel.title)}</title>'
        f'<desc id="{name}-text">{escape(panel.text)}</desc>'
    )
    return Markup(head + _shorter(inner))


def _shorter(text: str) -> str:
    """Give an SVG with what repeats said once, and coordinates to a hundredth of a point."""
    text = TAG.sub(lambda tag: LONG_NUMBER.sub(lambda own: f"{float(own[0]):.2f}", tag[0]), text)
    text = MARKS.sub(lambda own: _grouped(*own.groups()), text)
    return re.sub(r"\n\s*", "\n", text)


def _grouped(clip: str, marks: str, style: str) -> str:
    return f'<g{clip} style="{style}">' + marks.replace(f' style="{style}"', "")


def pdf(panels: Sequence[Panel]) -> bytes:
    """Give all panels on one sheet, for print."""
    columns = min(COLUMNS, len(panels))
    rows = math.ceil(len(panels) / columns)
    width, height = max(own.width for own in panels), max(own.height for own in panels)
    with mpl.rc_context(STYLE):
        figure = _figure(width * columns, height * rows)
        for place, panel in enumerate(panels, 1):
            _drawn(figure.add_subplot(rows, columns, place), panel)
        if len(panels) > 1:
            figure.subplots_adjust(
                left=0.75 / (width * columns), right=1 - 0.15 / (width * columns), top=1 - 0.3 / (height * rows),
                bottom=0.45 / (height * rows), wspace=0.4, hspace=0.5,
            )  # fmt: skip
        data = io.BytesIO()
        figure.savefig(data, format="pdf", metadata={"CreationDate": None})
    return data.getvalue()


def _figure(width: float, height: float) -> Figure:
    return Figure(figsize=(width, height), facecolor="none")


def _drawn(axes: Axes, panel: Panel) -> None:
    axes.set_facecolor("none")
    lines = textwrap.wrap(panel.title, round(LETTERS * panel.width / WIDTH))
    axes.set_title("\n".join(lines), loc="left")
    top = 1 - (0.1 + 0.15 * len(lines)) / panel.height
    sides = {"left": 0.62 / panel.width, "right": 1 - 0.08 / panel.width}
    axes.figure.subplots_adjust(**sides, top=top, bottom=0.42 / panel.height)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(INTERVALS, steps=[1, 2, 5, 10]))
    panel.draw(axes)
