"""The README's pictures: the chain, and the error of each engine from default to tuned, from the table of accuracy.

python docs/pictures.py docs/accuracy.md docs/_static
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from engines import engine
from reports.figures.matplotlib_backend import PRINT_STYLE
from reports.figures.style import PALETTE

WIDTH = 6.4
"""Of the pictures [inch]: that of a page of text, and still read on a telephone."""

STYLE = PRINT_STYLE | {
    "font.size": 11.0,
    "axes.labelsize": 11.0,
    "xtick.labelsize": 10.0,
    "ytick.labelsize": 10.0,
    "legend.fontsize": 10.5,
}

ERROR = "map, 800 [dB]"
FORMULATIONS = {"joint": (PALETTE[0], "o", -0.17), "contact": (PALETTE[1], "s", 0.17)}
"""Colour, shape, and place beside the line of an engine."""

DARK = "0.2"
CELLS = 7


def errors(table: Path) -> pd.DataFrame:
    """Give the columns *default* and *tuned* of each engine and formulation [dB], in the order of the table."""
    lines = [line for line in table.read_text(encoding="utf-8").splitlines() if line.startswith("| ")]
    header, *cells = ([cell.strip() for cell in line.strip("|").split("|")] for line in lines)
    rows = pd.DataFrame(cells, columns=header).query("preset in ('default', 'tuned') and engine != 'reference'")
    rows = rows.assign(**{ERROR: rows[ERROR].astype(float)})
    return rows.pivot_table(index=["engine", "formulation"], columns="preset", values=ERROR, sort=False)


def scheme_error(table: Path) -> float:
    """Give the error of the reference itself with the same steps [dB]."""
    line = next(
        line for line in table.read_text(encoding="utf-8").splitlines() if "| reference | joint | tuned" in line
    )
    return float(line.strip("|").split("|")[5])


def draw_errors(table: Path, picture: Path) -> None:
    """Draw a line from the default to the tuned error for each engine and formulation, the largest first."""
    rows, own = errors(table), scheme_error(table)
    names = rows["default"].groupby("engine").max().sort_values(ascending=False).index.tolist()
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(figsize=(WIDTH, 0.28 * len(names) + 1.2), layout="constrained")
        axes.axvline(own, color=DARK, linewidth=0.8, linestyle="--")
        axes.text(1.08 * own, -0.62, f"error of the scheme’s own time step: {own:g} dB", color=DARK, fontsize=9.5)
        for formulation, (colour, shape, shift) in FORMULATIONS.items():
            drawn = rows.xs(formulation, level="formulation")
            heights = np.array([names.index(name) for name in drawn.index]) + shift
            axes.hlines(heights, drawn["tuned"], drawn["default"], color=colour, linewidth=1.6)
            for preset, filling in (("default", "white"), ("tuned", colour)):
                axes.plot(
                    drawn[preset], heights, shape, color=colour, markerfacecolor=filling, markersize=5.5,
                    label=f"{formulation}, {preset}",
                )  # fmt: skip
        axes.set(xscale="log", xlabel="largest error to the exact motion [dB]", ylim=(len(names) - 0.4, -1.1))
        axes.set_yticks(range(len(names)), [engine(name).capabilities.title for name in names])
        ticks = (0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50)
        axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
        axes.minorticks_off()
        figure.legend(loc="outside upper center", ncols=2, columnspacing=2.0)
        figure.savefig(picture, metadata={"Date": None})
    plt.close(figure)


def draw_chain(picture: Path) -> None:
    """Draw the base and the cells: outer masses in a row, each with an inner mass that slides in it."""
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(figsize=(WIDTH, 1.2), layout="constrained")
        axes.add_patch(Rectangle((-1.1, -0.1), 0.35, 1.2, facecolor="0.8", edgecolor=DARK))
        axes.annotate("", (-0.45, 1.45), (-1.4, 1.45), arrowprops={"arrowstyle": "<->", "color": DARK})
        axes.text(-0.92, 1.6, "base", ha="center")
        for cell in range(CELLS):
            left = 1.9 * cell
            _spring(axes, left - (0.75 if cell == 0 else 0.5), left, 0.5)
            _cell(axes, left)
        for x, name, colour in (
            (1.9, "outer mass", DARK),
            (7.6, "inner mass", PALETTE[0]),
            (11.4, "friction", PALETTE[1]),
        ):
            axes.text(x + 0.7, 1.35, name, ha="center", color=colour)
        axes.set(xlim=(-1.5, 1.9 * CELLS), ylim=(-0.3, 2.0), aspect="equal")
        axes.axis("off")
        figure.savefig(picture, metadata={"Date": None})
    plt.close(figure)


def _cell(axes: Axes, left: float) -> None:
    """Draw a cell whose outer mass begins at `left`."""
    axes.add_patch(Rectangle((left, -0.1), 1.4, 1.2, facecolor="white", edgecolor=DARK, linewidth=2.0))
    _spring(axes, left, left + 0.55, 0.5)
    axes.add_patch(Rectangle((left + 0.55, -0.1), 0.6, 0.95, facecolor=PALETTE[0], alpha=0.75))
    axes.plot([left + 0.5, left + 1.2], [-0.1, -0.1], color=PALETTE[1], linewidth=4.0, solid_capstyle="butt")


def _spring(axes: Axes, start: float, end: float, height: float) -> None:
    """Draw a spring."""
    along = np.linspace(start, end, 9)
    across = height + 0.13 * np.array([0, 0, 1, -1, 1, -1, 1, 0, 0])
    axes.plot(along, across, color=DARK, linewidth=1.0)


def main(table: Path, folder: Path) -> None:
    """Write both pictures."""
    draw_chain(folder / "chain.svg")
    draw_errors(table, folder / "errors.svg")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
