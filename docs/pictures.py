"""The README's picture of errors: that of each engine by its preset, from the table of accuracy.

python docs/pictures.py docs/results/accuracy.csv docs/_static/errors.svg
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from multibody_xval.engines import engine
from multibody_xval.reports.figures.style import PALETTE, PRINT_STYLE

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

MARKS = {
    "default": ("default options", "white", 5.5), "tuned": ("tuned to the chain", "", 5.5),
    "recommended": ("recipe", "0.9", 3.2),
}  # fmt: skip
"""Presets, with name, filling (their own colour without one) and size of their marks; later ones are on top."""

DARK = "0.2"


def errors(table: Path) -> pd.DataFrame:
    """Give the errors of each engine and formulation by preset [dB], in the order of the table.

    Those of presets that are not periodic at most points are left out.
    """
    rows = pd.read_csv(table).query("preset in @MARKS and engine != 'reference'")
    periodic = rows["periodic"].str.split("/", expand=True).astype(int)
    rows = rows[2 * periodic[0] >= periodic[1]]
    return rows.pivot_table(index=["engine", "formulation"], columns="preset", values=ERROR, sort=False)


def scheme_error(table: Path) -> float:
    """Give the error of the reference itself with the same steps [dB]."""
    return float(pd.read_csv(table).set_index("engine").loc["reference", ERROR])


def draw_errors(table: Path, picture: Path) -> None:
    """Draw a line from the default to the tuned error, the largest first, and the recommended one beside."""
    rows, own = errors(table), scheme_error(table)
    names = rows["default"].groupby("engine").max().sort_values(ascending=False).index.tolist()
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(figsize=(WIDTH, 0.28 * len(names) + 1.2), layout="constrained")
        axes.axvline(own, color=DARK, linewidth=0.8, linestyle="--")
        axes.text(1.08 * own, -0.62, f"error of the time step: {own:g} dB", color=DARK, fontsize=9.5)
        for formulation, (colour, shape, shift) in FORMULATIONS.items():
            drawn = rows.xs(formulation, level="formulation")
            heights = np.array([names.index(name) for name in drawn.index]) + shift
            axes.hlines(heights, drawn["tuned"], drawn["default"], color=colour, linewidth=1.6)
            for preset, (name, filling, size) in MARKS.items():
                axes.plot(
                    drawn[preset], heights, shape, color=colour, markerfacecolor=filling or colour, markersize=size,
                    label=f"{formulation}, {name}",
                )  # fmt: skip
        axes.set(xscale="log", xlabel="largest error [dB]; 6 dB is a factor of 2", ylim=(len(names) - 0.4, -1.1))
        axes.set_yticks(range(len(names)), [engine(name).capabilities.title for name in names])
        ticks = (0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50)
        axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
        axes.minorticks_off()
        figure.legend(loc="outside upper center", ncols=2, columnspacing=2.0)
        figure.savefig(picture, metadata={"Date": None})
    plt.close(figure)


if __name__ == "__main__":
    draw_errors(*map(Path, sys.argv[1:]))
