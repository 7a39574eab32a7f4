"""The tables of engines in the page of one block, from the verdicts of its scenarios.

python docs/blocks/answers.py docs/blocks/answers.csv static-hold.csv breakaway.csv stopping-distance.csv direction.csv
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

COLUMNS = {
    "creep, load 0.5 [µm/s]": ("static-hold", "1 kg, load 0.5", "creep"),
    "creep, load 0.99 [µm/s]": ("static-hold", "1 kg, load 0.99", "creep"),
    "creep, load 0.99, shaken [µm/s]": ("static-hold", "1 kg, load 0.99, shaken", "creep"),
    "breakaway": ("breakaway", "1 kg, 2 ms", "breakaway"),
    "stopping distance": ("stopping-distance", "1 kg, 4.9 m/s", "distance"),
    "drift at rest [µm/s]": ("stopping-distance", "1 kg, 4.9 m/s", "drift"),
    "friction at 45°": ("direction", "1 kg, 4.9 m/s, 45°", "bound"),
}
"""Scenario, case and metric of each column: the block of 1 kg."""

UNASKED = "–"
"""Where a variant does not answer: joints have no direction, and an engine may be missing."""


def text(row: pd.Series) -> str:
    """Give a value as the table shows it: with ``p`` behind it where its law predicts it, ``*`` where none does."""
    if row["verdict"] not in ("agree", "disagree"):
        return UNASKED if row["verdict"] == "blocked" else str(row["verdict"])
    number = "0" if abs(row["value"]) < 1e-6 else f"{row['value']:.4g}"
    mark = "" if row["verdict"] == "agree" else " p" if row["modelled"] is True else " *"
    return number + mark


def write(table: Path, verdicts: Sequence[Path]) -> None:
    """Write a row a variant."""
    rows = pd.concat(map(pd.read_csv, verdicts))
    rows.insert(0, "variant", rows["engine"] + ":" + rows["formulation"] + ":" + rows["preset"])
    parts = {}
    for name, (scenario, case, metric) in COLUMNS.items():
        asked = rows[(rows["scenario"] == scenario) & (rows["case"] == case) & (rows["metric"] == metric)]
        parts[name] = asked.set_index("variant").apply(text, axis="columns") if len(asked) else pd.Series(dtype=str)
    wide = pd.DataFrame(parts, index=list(dict.fromkeys(rows["variant"]))).fillna(UNASKED)
    wide = wide[(wide != UNASKED).any(axis="columns")]
    wide.to_csv(table, index_label="engine:formulation:preset", lineterminator="\n")


if __name__ == "__main__":
    write(Path(sys.argv[1]), [Path(name) for name in sys.argv[2:]])
