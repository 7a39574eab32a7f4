"""How things are drawn, on the page and in print: colours, shapes, lines and sizes, the same everywhere."""

from dataclasses import dataclass
from typing import Any

from engines.interface.variant import Variant
from scenarios.sweeps.sweep import Sweep
from scenarios.verdicts.steady_case import REFERENCE

COLUMN = 3.5
"""Width of one column of a journal [inch]."""

PAGE_WIDTH = 7.2
"""Width of two columns with the gap between them [inch]."""

PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
"""Okabe and Ito's palette, which colour-blind readers can tell apart."""

PRINT_STYLE: dict[Any, Any] = {
    "font.size": 8.0,
    "axes.titlesize": 8.0,
    "axes.labelsize": 8.0,
    "legend.fontsize": 7.0,
    "legend.title_fontsize": 7.0,
    "xtick.labelsize": 7.0,
    "ytick.labelsize": 7.0,
    "lines.linewidth": 1.1,
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "axes.grid": True,
    "grid.color": "0.88",
    "grid.linewidth": 0.5,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
    "savefig.dpi": 300.0,
    "svg.fonttype": "path",
    "svg.hashsalt": "multibody-xval",
    "pdf.fonttype": 42,
}
"""Style of printed figures: 8 points in a column's width, thin lines, outlined text."""

_SHAPES = (
    ("o", "circle-open"), ("s", "square-open"), ("^", "triangle-up-open"), ("D", "diamond-open"),
    ("v", "triangle-down-open"), ("P", "cross-open"), ("X", "x-open"), ("*", "star-open"),
)  # fmt: skip
_SIZES = (6.0, 4.8, 4.6, 3.4, 4.4, 4.2, 4.0, 5.4)
_DASHES: tuple[tuple[Any, str], ...] = (
    ((0, (5, 1.5)), "8px,3px"), ((0, (1, 1)), "2px,2px"), ((0, (4, 1, 1, 1)), "7px,2px,2px,2px"),
    ((0, (8, 2)), "12px,4px"), ((0, (4, 1, 1, 1, 1, 1)), "7px,2px,2px,2px,2px,2px"),
)  # fmt: skip


@dataclass(frozen=True)
class Look:
    """How one variant is drawn: colour, shape, size and line all differ, so that any one of them is enough.

    Parameters
    ----------
    colour
        As ``#rrggbb``.
    marker, symbol
        The same hollow shape, for matplotlib and for plotly.
    size
        Of the shape in print [pt].
    line, dash
        The same pattern of dashes, for matplotlib and for plotly.
    """

    colour: str
    marker: str
    symbol: str
    size: float
    line: Any
    dash: str

    def printed(self, *, lines: bool = False) -> dict[str, Any]:
        """Keywords of `Axes.plot`: hollow markers, joined by lines where that is asked for."""
        return {
            "color": self.colour,
            "marker": self.marker,
            "markersize": self.size,
            "markerfacecolor": "none",
            "markeredgewidth": 0.8,
            "linestyle": self.line if lines else "none",
        }

    @property
    def plotly_marker(self) -> dict[str, Any]:
        """The marker of a trace."""
        return {
            "color": self.colour,
            "symbol": self.symbol,
            "size": round(1.6 * self.size, 1),
            "line": {"width": 1.5, "color": self.colour},
        }

    @property
    def plotly_line(self) -> dict[str, Any]:
        """The line of a trace."""
        return {"color": self.colour, "dash": self.dash, "width": 1.8}


REFERENCE_LOOK = Look("#000000", "x", "x-thin", 4.5, "-", "solid")
"""The reference: black and solid in every figure."""


def compared_variants(sweep: Sweep) -> list[Variant]:
    """Variants of engines other than the reference, in their order."""
    return [variant for variant in sweep.variants if variant.engine != REFERENCE.engine]


def look_of(sweep: Sweep, variant: Variant) -> Look:
    """Give a variant its look, the same in every figure."""
    if variant.engine == REFERENCE.engine:
        return REFERENCE_LOOK
    place = compared_variants(sweep).index(variant)
    colours, shapes = len(PALETTE), len(_SHAPES)
    # one shape further each time that the colours are used up: 48 variants in a row differ
    shape = (place + place // colours) % shapes
    line, dash = _DASHES[place % len(_DASHES)]
    return Look(PALETTE[place % colours], *_SHAPES[shape], _SIZES[shape], line, dash)


def curve_look(place: int) -> tuple[str, Any, str]:
    """Colour and line, for matplotlib and for plotly, of the curve at this place among the cases."""
    if place == 0:
        return "#000000", "-", "solid"
    return (PALETTE[(place - 1) % len(PALETTE)], *_DASHES[(place - 1) % len(_DASHES)])
