"""The rose of the page of one block: the bound of friction over the direction of the slip, from its numbers.

multibody-xval run direction --engine all:all:all --out direction.csv
python docs/blocks/rose.py docs/blocks/directions.csv docs/_static/rose.svg direction.csv

Rows of the table stay where there are no numbers of their configuration.
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

SCALE = "1 kg"
SPEEDS = ("0.49", "4.9")
"""Velocities at first [m/s], as the cases name them."""

ALIKE = 0.004
"""Largest difference of bounds that are drawn as one curve: less than the width of a line."""

LARGEST = 1.5
"""Bound at which the figure ends; what is beyond it is left out, and the table has it."""


def bounds(numbers: Path) -> pd.DataFrame:
    """Give bounds by configuration and speed, a column an angle; those that turn their rows."""
    rows = pd.read_csv(numbers)
    rows = rows[rows["scenario"] == "direction"]
    parts = rows["case"].str.extract(rf"^{SCALE}, ([\d.]+) m/s, (\d+)°$")
    rows = rows.assign(speed=parts[0], angle=parts[1].astype(float))
    table = rows.pivot_table(index=["speed", "configuration"], columns="angle", values="value", sort=False)
    return table.dropna().rename(columns="{:g}°".format)


def alike(table: pd.DataFrame) -> list[tuple[str, pd.Series]]:
    """Give each curve once, with the names of all that share it."""
    groups: list[tuple[list[str], pd.Series]] = []
    for name, curve in table.iterrows():
        same = next((names for names, known in groups if np.abs(known - curve).max() < ALIKE), None)
        if same is None:
            groups.append(([str(name)], curve))
        else:
            same.append(str(name))
    return [("\n".join(names), curve) for names, curve in groups]


def draw(table: pd.DataFrame, picture: Path) -> None:
    """Draw a quarter of a rose for each speed; the others follow from the symmetry of the bodies."""
    figure, panels = plt.subplots(2, 1, figsize=(7.5, 9.5), subplot_kw={"projection": "polar"}, layout="constrained")
    degrees = [float(name.removesuffix("°")) for name in table.columns]
    colours: dict[str, str] = {}
    for axes, speed in zip(panels, SPEEDS, strict=True):
        for names, curve in alike(table.loc[speed]):
            if curve.max() < LARGEST:
                colour = colours.setdefault(names.split("\n")[0], f"C{len(colours)}")
                axes.plot(np.radians(degrees), curve, color=colour, marker="o", markersize=3.5, label=names)
        axes.set(thetamin=0, thetamax=90, rmin=0, rmax=LARGEST)
        axes.set_title(f"slip of {speed} m/s", loc="left", pad=14)
        axes.set_thetagrids(degrees)
        axes.set_rticks([0.5, 1.0, LARGEST], labels=["0.5", "1", "1.5 μλ$_N$"])
        axes.legend(loc="center left", bbox_to_anchor=(1.08, 0.5), fontsize=7, frameon=False, labelspacing=1.2)
    with plt.rc_context({"svg.hashsalt": "rose"}):
        figure.savefig(picture, metadata={"Date": None})
    plt.close(figure)


def main(table: Path, picture: Path, numbers: Path) -> None:
    """Write the table and the picture."""
    found = bounds(numbers).round(4)
    if table.is_file():
        known = pd.read_csv(table, dtype={"speed": str}, index_col=["speed", "configuration"])
        order = dict.fromkeys([*known.index, *found.index])
        found = pd.concat([known.drop(found.index, errors="ignore"), found]).loc[list(order)]
    found.to_csv(table, lineterminator="\n")
    draw(found, picture)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
