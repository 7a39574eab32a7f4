"""The table of engines in the index of the target sheets, from the numbers of the scenario `published`.

multibody-xval run published --engine all:all:all --out published.csv
python docs/targets/answers.py published.csv docs/targets/answers.csv

Rows of the table stay where there are no numbers of their configuration.
"""

import sys
from pathlib import Path

import pandas as pd

MARKS = {"agrees": "", "deviates": " *", "time step too large": " c"}
"""Behind a value; where there is none, the verdict stands in its place."""

NAMES = "engine:formulation:preset"


def cell(value: float, exact: float, verdict: str) -> str:
    """Give a value as the table shows it: over the exact one where that is not 0."""
    if verdict not in MARKS:
        return verdict
    size = value / exact if exact else value
    text = "0" if abs(size) < 1e-9 else f"{size:.4g}" if exact == 0 else f"{size:.5f}"
    return text + MARKS[verdict]


def write(numbers: Path, table: Path) -> None:
    """Write a row a configuration, a column a published number."""
    rows = pd.read_csv(numbers).query("scenario == 'published'")
    rows = rows[~rows.reason.fillna("").str.contains("not installed")].assign(**{NAMES: rows.configuration})
    rows["cell"] = list(map(cell, rows.value, rows.exact, rows.verdict))
    wide = rows.pivot_table(index=NAMES, columns="case", values="cell", aggfunc="first", sort=False)
    if table.exists():
        before = pd.read_csv(table, index_col=NAMES, dtype=str)
        order = dict.fromkeys([*before.index, *wide.index])
        wide = pd.concat([before.drop(wide.index, errors="ignore"), wide]).loc[list(order)]
    wide.to_csv(table, lineterminator="\n")


if __name__ == "__main__":
    write(Path(sys.argv[1]), Path(sys.argv[2]))
