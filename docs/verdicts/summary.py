"""The table of verdicts that the documentation is made of: a row a scenario, configuration and quantity.

multibody-xval run all --engine mujoco:all:all --out mujoco.csv
python docs/verdicts/summary.py docs/verdicts/verdicts.csv mujoco.csv ...

Rows of the table stay where there are no numbers of their scenario and configuration.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from multibody_xval.scenarios.ruler.judge import VERDICTS

CONFIG = ["engine", "formulation", "preset"]

GROUP = ["scenario", *CONFIG, "quantity", "unit"]
"""What one row is about."""

NUMBERS = ("value", "exact", "distance", "allowed")
"""Columns that can be empty."""

WORST = ["case", *NUMBERS, "reason"]
"""Of the case whose distance is largest beside what is allowed; the reason where there is no number."""

NOT_THERE = "not installed|needs an environment"
"""What reasons say of an engine that was not there."""

DIGITS = 5
"""Significant ones of a number."""


def summarised(numbers: pd.DataFrame) -> pd.DataFrame:
    """Count verdicts, and keep the worst case of each group."""
    numbers = numbers.assign(
        unit=numbers.unit.fillna(""),
        reason=numbers.reason.fillna("").mask(numbers.distance.notna(), ""),
        excess=(numbers.distance / numbers.allowed).fillna(-1.0),
    )
    groups = numbers.groupby(GROUP, sort=False)
    counts = groups.verdict.value_counts().unstack(fill_value=0).reindex(columns=list(VERDICTS), fill_value=0)
    worst = numbers.loc[groups.excess.idxmax()].set_index(GROUP)[WORST]
    return groups.judged.any().to_frame().join(counts).join(worst).reset_index()


def run_here(numbers: pd.DataFrame) -> pd.DataFrame:
    """Leave out engines that were not there."""
    return numbers[~numbers.reason.fillna("").str.contains(NOT_THERE)].reset_index(drop=True)


def merged(before: pd.DataFrame, rows: pd.DataFrame) -> pd.DataFrame:
    """Put rows in the place of those of the same scenario and configuration, or behind those of their scenario."""
    names = ["scenario", *CONFIG]
    known, made = (pd.MultiIndex.from_frame(each[names]) for each in (before, rows))
    joined = pd.concat([before[~known.isin(made)], rows]).reset_index(drop=True)
    order = [pd.Index(pd.concat([before, rows])[name].unique()) for name in names[:2]]
    places = pd.DataFrame({name: own.get_indexer(joined[name]) for name, own in zip(names, order, strict=False)})
    return joined.loc[places.sort_values(names[:2], kind="stable").index]


def read(table: Path) -> pd.DataFrame:
    """Read the table; only numbers may be missing."""
    return pd.read_csv(table, keep_default_na=False, na_values=dict.fromkeys(NUMBERS, ""))


def main(table: Path, files: Sequence[Path]) -> None:
    """Write the table."""
    numbers = [pd.read_csv(file, dtype={"unit": str, "reason": str}) for file in files]
    rows = summarised(run_here(pd.concat(numbers, ignore_index=True)))
    if table.is_file():
        rows = merged(read(table), rows)
    rows.to_csv(table, index=False, float_format=f"%.{DIGITS}g", lineterminator="\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]), [Path(name) for name in sys.argv[2:]])
