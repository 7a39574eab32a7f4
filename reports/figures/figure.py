"""A picture of the report: one drawing for print and one for the screen, of the same numbers."""

import base64
import io
import math
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure
from PIL import Image

from reports.figures.style import PRINT_STYLE

PIXELS = 150
"""Dots an inch of pictures of pixels."""

Draw = Callable[[], Figure]


@dataclass(frozen=True)
class Picture:
    """One picture.

    Parameters
    ----------
    name
        Name of its files, without the ending, and its identifier in the page; unique in a report.
    caption
        What is seen, in a sentence.
    draw
        Draws it for print, in the style of `reports.figures.style.PRINT_STYLE`.
    plot
        The figure of plotly that stands on the page: ``data`` and ``layout``.
    wide
        It takes two columns of a journal, and the whole width of the page.
    dense
        It holds so much that the page has a picture of pixels of it, which is smaller than the drawing.
    """

    name: str
    caption: str
    draw: Draw
    plot: Mapping[str, Any]
    wide: bool = False
    dense: bool = False

    def print_files(self) -> dict[str, bytes]:
        """Draw once; give the picture as SVG and as PDF, by ending, and as PNG if it is dense."""
        with mpl.rc_context(PRINT_STYLE):
            figure = self.draw()
            files = {}
            if self.dense:
                files["png"] = _few_colours(_saved(figure, "png", {"Software": None}))
            else:
                figure.draw_without_rendering()
            figure.set_layout_engine("none")  # it is laid out; no file needs it again
            files["svg"] = _saved(figure, "svg", dict.fromkeys(("Creator", "Date", "Format", "Type")))
            files["pdf"] = _saved(figure, "pdf", dict.fromkeys(("Creator", "Producer", "CreationDate")))
            return files


def _saved(figure: Figure, ending: str, metadata: dict[str, Any]) -> bytes:
    file = io.BytesIO()
    figure.savefig(file, format=ending, metadata=metadata, dpi=PIXELS if ending == "png" else "figure")
    return file.getvalue()


def _few_colours(png: bytes) -> bytes:
    """Give a picture with a palette of its own: a fraction of its bytes, and nobody sees it in lines and markers."""
    file = io.BytesIO()
    Image.open(io.BytesIO(png)).convert("RGB").quantize(64).save(file, "png", optimize=True)
    return file.getvalue()


def inline_png(png: bytes, picture: Picture) -> str:
    """Give a picture of pixels as an element for a page."""
    address = f"data:image/png;base64,{base64.b64encode(png).decode('ascii')}"
    return f'<img alt="{_quoted(picture.caption)}" src="{address}">'


def inline_svg(svg: bytes, name: str, caption: str) -> str:
    """Give an SVG file as an element for a page: no prologue, no addresses, identifiers of its own, a description."""
    text = svg.decode("utf-8")
    text = text[text.index("<svg") :]
    text = re.sub(r'\sxmlns(:\w+)?="[^"]*"', "", text)
    for side in ("width", "height"):
        text = re.sub(rf'(<svg[^>]*?)\s{side}="[^"]*"', r"\1", text, count=1)
    # several figures stand in one document, and matplotlib gives each the same identifiers
    text = re.sub(r'\bid="', f'id="{name}-', text)
    text = re.sub(r'xlink:href="#', f'href="#{name}-', text)
    text = re.sub(r'xlink:href="data:', 'href="data:', text)
    return text.replace("url(#", f"url(#{name}-").replace("<svg", f'<svg role="img" aria-label="{_quoted(caption)}"', 1)


def _quoted(text: str) -> str:
    return re.sub(r'[<>"&]', "", text)


def rounded(values: Iterable[float], digits: int = 4) -> list[float | None]:
    """Give numbers as a page holds them: this many decimals, and nothing where there is no number."""
    return [round(float(value), digits) if math.isfinite(value) else None for value in values]


def significant(values: Iterable[float], digits: int = 4) -> list[float | None]:
    """Give numbers with this many digits that count."""
    return [float(f"{value:.{digits}g}") if math.isfinite(value) else None for value in values]


def axis(title: str, **more: Any) -> dict[str, Any]:
    """Give an axis of plotly with a title."""
    return {
        "title": {"text": title, "standoff": 8},
        "gridcolor": "#e3e6ea",
        "zeroline": False,
        "linecolor": "#57606a",
        "ticks": "outside",
        "tickcolor": "#57606a",
        "automargin": True,
        **more,
    }


def layout(height: int, **more: Any) -> dict[str, Any]:
    """Give the layout of a plot, `height` pixels high without its legend."""
    return {
        "height": height,
        "margin": {"l": 60, "r": 16, "t": 10, "b": 48},
        "font": {"family": "system-ui, Segoe UI, Liberation Sans, Arial, sans-serif", "size": 13, "color": "#1b1f24"},
        "plot_bgcolor": "#fff",
        "paper_bgcolor": "#fff",
        "hovermode": "closest",
        "hoverlabel": {"namelength": -1},
        "legend": {"orientation": "h", "x": 0, "xanchor": "left", "y": 1, "yanchor": "top", "yref": "container"},
        **more,
    }
