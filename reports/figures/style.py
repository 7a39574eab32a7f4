"""Colours and sizes of pictures in the documentation and in print."""

from typing import Any

COLUMN = 3.5
"""Width of one column of a journal [inch]."""

PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
"""Okabe and Ito's palette, which colour-blind readers can distinguish."""

INK, LINE, PAPER = "#1b1f24", "#d5dae0", "#ffffff"
"""Text and axes, grids, and the ground."""

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
