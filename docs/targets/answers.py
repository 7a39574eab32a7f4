"""The table of engines in the index of the target sheets, from the verdicts of the scenario `published`.

python docs/targets/answers.py published.csv docs/targets/answers.csv

Rows of the table stay where there are no verdicts of their variant.
"""

import sys
from pathlib import Path

import pandas as pd

MARKS = {"agree": "", "disagree": " *", "own step too coarse": " c", "inconclusive": " ?"}
"""Behind a value; where there is none, the verdict stands in its place."""

VARIANT = "engine:formulation:preset"


def cell(row: pd.Series) -> str:
    """Give a value as the table shows it."""
    if pd.isna(row["value"]):
        return str(row["verdict"])
    size = row["value"] / row["expected"] if row["expected"] else row["value"]
    text = "0" if abs(size) < 1e-9 else f"{size:.4g}" if row["expected"] == 0 else f"{size:.5f}"
    predicted = row["modelled"] is True and row["verdict"] == "disagree"
    return text + (" p" if predicted else MARKS[row["verdict"]])


def write(verdicts: Path, table: Path) -> None:
    """Write a row a variant, a column a published number."""
    rows = pd.read_csv(verdicts).query("scenario == 'published'")
    rows = rows[~rows["reason"].str.contains("not installed")]
    rows[VARIANT] = rows["engine"] + ":" + rows["formulation"] + ":" + rows["preset"]
    rows["cell"] = rows.apply(cell, axis="columns")
    wide = rows.pivot_table(index=VARIANT, columns="case", values="cell", aggfunc="first", sort=False)
    if table.exists():
        before = pd.read_csv(table, index_col=VARIANT, dtype=str)
        wide = pd.concat([before.drop(wide.index, errors="ignore"), wide])
    wide.to_csv(table, lineterminator="\n")


if __name__ == "__main__":
    write(Path(sys.argv[1]), Path(sys.argv[2]))
