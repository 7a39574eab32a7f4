"""The tables of engines in the page of one block, from the numbers of its scenarios.

multibody-xval run static-hold breakaway stopping-distance --engine mujoco:all:all --out numbers.csv
python docs/blocks/answers.py docs/blocks/answers.csv numbers.csv ...

Rows of the table stay where there are no numbers of their configuration.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

COLUMNS = {
    "drift, load 0.5 [µm/s]": ("static-hold", "1 kg, load 0.5", "drift"),
    "drift, load 0.99 [µm/s]": ("static-hold", "1 kg, load 0.99", "drift"),
    "drift, load 0.99, shaken [µm/s]": ("static-hold", "1 kg, load 0.99, shaken", "drift"),
    "breakaway": ("breakaway", "1 kg, 2 ms", "breakaway"),
    "stopping distance": ("stopping-distance", "1 kg, 4.9 m/s", "distance"),
    "drift at rest [µm/s]": ("stopping-distance", "1 kg, 4.9 m/s", "drift"),
}
"""Scenario, case and quantity of each column: the block of 1 kg."""

NAMES = "engine:formulation:preset"

UNASKED = "–"
"""Where a configuration does not answer: an engine may be missing, or cannot represent the case."""

MARKS = {"agrees": "", "deviates": " *", "time step too large": " c"}
"""Behind a value; where there is none, the verdict stands in its place."""


def text(value: float, verdict: str) -> str:
    """Give a value as the tables show it."""
    if verdict not in MARKS:
        return UNASKED if verdict == "unsupported" else verdict
    return ("0" if abs(value) < 1e-6 else f"{value:.4g}") + MARKS[verdict]


def merged(before: Path, rows: pd.DataFrame, index: list[str]) -> pd.DataFrame:
    """Put rows in the place of those of a table, or behind them."""
    if not before.is_file():
        return rows
    known = pd.read_csv(before, index_col=index, dtype=str)
    order = dict.fromkeys([*known.index, *rows.index])
    return pd.concat([known.drop(rows.index, errors="ignore"), rows]).loc[list(order)]


def write(table: Path, files: Sequence[Path]) -> None:
    """Write a row a configuration."""
    rows = pd.concat(map(pd.read_csv, files))
    parts = {}
    for name, (scenario, case, quantity) in COLUMNS.items():
        asked = rows[(rows.scenario == scenario) & (rows.case == case) & (rows.quantity == quantity)]
        parts[name] = pd.Series(list(map(text, asked.value, asked.verdict)), asked.configuration, dtype=object)
    wide = pd.DataFrame(parts, index=list(dict.fromkeys(rows.configuration))).fillna(UNASKED)
    wide = wide[(wide != UNASKED).any(axis="columns")].rename_axis(NAMES)
    merged(table, wide, [NAMES]).to_csv(table, lineterminator="\n")


if __name__ == "__main__":
    write(Path(sys.argv[1]), [Path(name) for name in sys.argv[2:]])
