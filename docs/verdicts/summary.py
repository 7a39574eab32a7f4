"""The table of verdicts that the documentation is made of: a row a scenario, variant and metric, from findings.

multibody-xval run figure3 --engine all --out figure3.csv
python docs/verdicts/summary.py docs/verdicts/verdicts.csv figure3.csv ...

Rows of the table stay where there are no findings of their scenario and variant.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

NOT_THERE = "is not installed|needs an environment|skipped"
"""What reasons say of an engine that was not there, or of a chain that would take too long."""

VARIANT = ["engine", "formulation", "preset"]

GROUP = ["scenario", *VARIANT, "metric", "unit"]
"""What one row is about."""

WORDS = {"agree": "agrees", "own step too coarse": "inconclusive", "inconclusive": "inconclusive"}
"""Outcomes by verdict, where the law has no say."""

NUMBERS = ("value", "expected", "difference", "allowed")
"""Columns that can be empty."""

COUNTS = ["agrees", "modelled", "unmodelled", "inconclusive", "blocked"]
"""Columns of outcomes."""

WORST = ["case", "value", "expected", "difference", "allowed", "reason"]
"""Of the finding whose difference is largest beside what is allowed; the reason where there is no difference."""

DIGITS = 5
"""Significant ones of a number."""


def outcomes(findings: pd.DataFrame) -> pd.Series:
    """Give one word a finding."""
    words = findings["verdict"].replace(WORDS)
    predicted = findings["modelled"].astype(str) == "True"
    return words.mask(words == "disagree", predicted.map({True: "modelled", False: "unmodelled"}))


def summarised(findings: pd.DataFrame) -> pd.DataFrame:
    """Count outcomes, and keep the worst finding of each group."""
    findings = findings.assign(
        unit=findings["unit"].fillna(""),
        outcome=outcomes(findings),
        excess=(findings["difference"].abs() / findings["allowed"]).fillna(-1.0),
    )
    counts = findings.groupby([*GROUP, "outcome"], sort=False).size().unstack("outcome", fill_value=0)
    worst = findings.loc[findings.groupby(GROUP, sort=False)["excess"].idxmax()].set_index(GROUP)[WORST]
    worst["reason"] = worst["reason"].mask(worst["difference"].notna(), "")
    return counts.join(worst).reset_index()


def run_here(findings: pd.DataFrame) -> pd.DataFrame:
    """Leave out variants that gave no number in a scenario because their engine was not there, or was left out."""
    missing = findings["reason"].str.contains(NOT_THERE) & findings["value"].isna()
    ran = findings["value"].notna().groupby([findings[name] for name in VARIANT]).transform("any")
    return findings[ran & ~missing].reset_index(drop=True)


def merged(before: pd.DataFrame, rows: pd.DataFrame) -> pd.DataFrame:
    """Put rows in the place of those of the same scenario and variant, or behind those of their scenario and engine."""
    names = ["scenario", *VARIANT]
    known, made = (pd.MultiIndex.from_frame(each[names]) for each in (before, rows))
    joined = pd.concat([before[~known.isin(made)], rows])
    joined = joined.fillna(dict.fromkeys(COUNTS, 0)).astype(dict.fromkeys(COUNTS, int))
    order = [pd.Index(pd.concat([before, rows])[name].unique()) for name in names[:2]]
    places = pd.DataFrame({name: own.get_indexer(joined[name]) for name, own in zip(names, order, strict=False)})
    return joined.iloc[places.sort_values(names[:2], kind="stable").index]


def main(table: Path, findings: Sequence[Path]) -> None:
    """Write the table."""
    rows = summarised(run_here(pd.concat(map(pd.read_csv, findings)).reset_index(drop=True)))
    if table.is_file():
        rows = merged(pd.read_csv(table, keep_default_na=False, na_values=dict.fromkeys(NUMBERS, "")), rows)
    rows.to_csv(table, index=False, float_format=f"%.{DIGITS}g", lineterminator="\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]), [Path(name) for name in sys.argv[2:]])
