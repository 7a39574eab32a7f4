"""The table of static friction above kinetic friction, from the numbers of its scenario.

multibody-xval run static-above-kinetic --engine sapien:all:all --out numbers.csv
python docs/blocks/static_above_kinetic.py docs/blocks/static_above_kinetic.csv numbers.csv ...

Rows of the table stay where there are no numbers of their configuration.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import pandas as pd
from answers import NAMES, merged, text

RATIO = "μ_s/μ_k"


def write(table: Path, files: Sequence[Path]) -> None:
    """Write a row a configuration and ratio, without those that cannot take part."""
    rows = pd.concat(map(pd.read_csv, files))
    rows = rows[(rows.scenario == "static-above-kinetic") & (rows.verdict != "unsupported")]
    parts = rows.case.str.rsplit(", ", n=1)
    rows = rows.assign(**{"scale": parts.str[0], RATIO: parts.str[1], NAMES: rows.configuration})
    rows["column"] = rows.quantity + ", " + rows.scale
    rows["text"] = list(map(text, rows.value, rows.verdict))
    wide = rows.pivot_table(index=[NAMES, RATIO], columns="column", values="text", aggfunc="first", sort=False)
    columns = [f"{name}, {own}" for name in ("breakaway", "jump") for own in dict.fromkeys(rows.scale)]
    merged(table, wide.reindex(columns=columns), [NAMES, RATIO]).to_csv(table, lineterminator="\n")


if __name__ == "__main__":
    write(Path(sys.argv[1]), [Path(name) for name in sys.argv[2:]])
