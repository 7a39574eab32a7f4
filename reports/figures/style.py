"""How things are drawn: colours, shapes, lines and sizes, the same on the page and in print."""

from collections.abc import Iterable, Mapping
from typing import Any

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE

COLUMN = 3.5
"""Width of one column of a journal [inch]."""

PAGE_WIDTH = 7.2
"""Width of two columns with the gap between them [inch]."""

PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
"""Okabe and Ito's palette, which colour-blind readers can distinguish."""

INK, SOFT, LINE, PAPER, BLANK = "#1b1f24", "#57606a", "#d5dae0", "#ffffff", "#fdfdfd"
"""Text and axes, what is less important, grids, the ground, and the ground of maps; the page has its own of each."""

PRINT_STYLE: dict[Any, Any] = {
    **dict.fromkeys(("font.size", "axes.titlesize", "axes.labelsize", "figure.labelsize"), 8.0),
    **dict.fromkeys(("legend.fontsize", "legend.title_fontsize", "xtick.labelsize", "ytick.labelsize"), 7.0),
    **dict.fromkeys(("text.color", "axes.edgecolor", "axes.labelcolor", "xtick.color", "ytick.color"), INK),
    **dict.fromkeys(("figure.facecolor", "axes.facecolor"), PAPER),
    "font.sans-serif": ["DejaVu Sans", "Verdana"],
    "axes.titlepad": 3.0,
    "legend.columnspacing": 1.0,
    "lines.linewidth": 1.1,
    **dict.fromkeys(("axes.linewidth", "xtick.major.width", "ytick.major.width"), 0.6),
    "axes.grid": True,
    "grid.color": LINE,
    "grid.linewidth": 0.5,
    "axes.axisbelow": True,
    **dict.fromkeys(("axes.spines.top", "axes.spines.right", "legend.frameon"), False),
    "savefig.dpi": 300.0,
    "svg.fonttype": "path",
    "svg.hashsalt": "multibody-xval",
    "pdf.fonttype": 42,
}
"""Style of figures: 8 points in a column's width, thin lines, outlined text."""

RULE: dict[str, Any] = {"color": SOFT, "linewidth": 0.6}
"""A thin grey line, such as that of a threshold."""

GREY: dict[str, Any] = {"color": "#8c8c8c", "linewidth": 1.6, "label": REFERENCE.title}
"""The reference, behind what is compared with it."""

HOLLOW = {"markerfacecolor": "none"}
"""Of shapes that others may cover."""

PRESETS: Mapping[str, dict[str, Any]] = {
    "as installed": {"color": "#D55E00", "marker": "o", "markersize": 5.5, "linestyle": "--", **HOLLOW},
    "recommended": {"color": "#009E73", "marker": "s", "markersize": 4.0, "linestyle": "-.", **HOLLOW},
    "tuned": {"color": "#0072B2", "marker": "o", "markersize": 2.5, "linestyle": "-"},
    "other presets": {"color": "#CC79A7", "marker": "D", "markersize": 3.0, "linestyle": ":", **HOLLOW},
}
"""How presets are drawn, by their titles."""

NAMED = dict(zip(("default", "recommended", "tuned"), PRESETS, strict=False))
"""Titles of presets that have one, by name."""


def preset_title(variant: Variant) -> str:
    """Give the title of the preset, by which its style is known."""
    return NAMED.get(variant.preset_name, "other presets")


def preset_style(variant: Variant) -> dict[str, Any]:
    """Give the style of a variant in the panel of its engine and formulation, with the name in the legend."""
    title = preset_title(variant)
    return {"linewidth": 0.9, "markeredgewidth": 0.8, "label": title, **PRESETS[title]}


def by_panel(variants: Iterable[Variant]) -> dict[str, list[Variant]]:
    """Group variants by panel, whose title names engine and formulation; presets without a title have their own."""
    panels: dict[str, list[Variant]] = {}
    for variant in variants:
        panel = variant.tuned if variant.preset_name in NAMED else variant
        panels.setdefault(panel.title, []).append(variant)
    return panels
