"""The table of static friction above kinetic friction, from the verdicts of its scenario.

python docs/blocks/static_above_kinetic.py docs/blocks/static_above_kinetic.csv static-above-kinetic.csv
"""

import sys
from pathlib import Path

import pandas as pd
from answers import text

TOO_COARSE = "own step too coarse"


def marked(row: pd.Series) -> str:
    """Give a value as `text` does, with ``c`` behind it where the variant's own step leaves too much of it open."""
    return f"{row['value']:.4g} c" if row["verdict"] == TOO_COARSE else text(row)


def write(table: Path, verdicts: Path) -> None:
    """Write a row a variant and ratio, without those that cannot take part."""
    rows = pd.read_csv(verdicts)
    rows = rows[rows["verdict"] != "blocked"]
    rows["variant"] = rows["engine"] + ":" + rows["formulation"] + ":" + rows["preset"]
    rows[["scale", "μ_s/μ_k"]] = rows["case"].str.rsplit(", ", n=1, expand=True)
    rows["column"] = rows["metric"] + ", " + rows["scale"]
    rows["text"] = rows.apply(marked, axis="columns")
    wide = rows.pivot_table(index=["variant", "μ_s/μ_k"], columns="column", values="text", aggfunc="first", sort=False)
    columns = [f"{metric}, {scale}" for metric in ("breakaway", "jump") for scale in dict.fromkeys(rows["scale"])]
    wide[columns].to_csv(table, index_label=["engine:formulation:preset", "μ_s/μ_k"], lineterminator="\n")


if __name__ == "__main__":
    write(*map(Path, sys.argv[1:]))
