"""Compares two folders that `tests.golden.record` wrote: ``python -m tests.golden.compare BEFORE NOW``.

It prints the largest differences, and a line a row that differs, and ends with 1 if there is any. Rows of engines and
presets that only one of the two folders has are counted, not compared: an engine may not be installed.
"""

import math
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import pandas as pd

ROUND_OFF = 1e-7
"""Relative difference of numbers that another processor computes: sums take other orders there."""

WRITTEN_DB, WRITTEN_DEG = 1e-7, 1e-4
"""What the digits of a file leave open of a level [dB] and a phase [deg]."""

RESOLUTION = {"µm/s": 0.1, "µrad/s": 0.1, "mm": 1e-3, "mrad": 1e-3, "°": 1e-3, "%": 1e-3, "in η_r": 1e-6}
"""Differences of scenes and blocks that count as none, by unit: creep has a resolution of 0.1 µm/s."""

PHASE_OF_DB = math.degrees(math.log(10) / 20)
"""Phase [deg] that is left open where this level [dB] is: both are parts of one complex number."""

Allowed = float | Callable[[pd.DataFrame], pd.Series] | None
"""What two numbers may differ by: a number, or a function of rows with the columns of both folders; ``None`` stands for
text, which has to be the same."""


def open_level(both: pd.DataFrame) -> pd.Series:
    """What the residuals of two steady states leave open [dB]."""
    return numbers(both.open_db_before) + numbers(both.open_db_now) + WRITTEN_DB


COLUMNS: Mapping[str, Mapping[str, Allowed]] = {
    "steady": {"status": None, "level_db": open_level, "stuck": None, "transitions": None,
               "phase_deg": lambda both: open_level(both) * PHASE_OF_DB + WRITTEN_DEG},
    "scenarios": {"value": lambda both: both.unit_now.map(RESOLUTION).fillna(ROUND_OFF)},
    "edges": {"frequency_ratio": lambda both: numbers(both.width_before) + numbers(both.width_now)},
}  # fmt: skip
"""Folders of files: the columns that are compared, and what they may differ by."""

NAMES: Mapping[str, list[str]] = {
    "steady": ["config", "point"],
    "scenarios": ["scenario", "case", "config", "quantity"],
    "edges": ["config", "friction_ratio", "edge"],
}
"""Columns that name a row of these files."""


def numbers(column: pd.Series) -> pd.Series:
    """Read a column of text; NaN where there is no number."""
    return pd.to_numeric(column.replace("", None))


def rows(folder: Path, part: str) -> pd.DataFrame:
    """Give the rows of the files of all engines, as text."""
    files = sorted((folder / part).glob("*.csv"))
    found = [pd.read_csv(file, dtype=str, keep_default_na=False) for file in files]
    return pd.concat(found, ignore_index=True) if found else pd.DataFrame(columns=NAMES[part])


def apart(name: str, both: pd.DataFrame) -> pd.Series:
    """Give by how much the numbers of a column differ."""
    change = numbers(both[f"{name}_now"]) - numbers(both[f"{name}_before"])
    return ((change + 180) % 360 - 180 if name == "phase_deg" else change).abs()


def differ(name: str, both: pd.DataFrame, allowed: Allowed) -> pd.Series:
    """Tell in which rows a column differs; two numbers that are missing or infinite do not."""
    before, now = both[f"{name}_before"], both[f"{name}_now"]
    if allowed is None:
        return before != now
    before, now = numbers(before), numbers(now)
    most = allowed(both) if callable(allowed) else allowed
    near = apart(name, both) <= most + ROUND_OFF * before.abs()
    return ~near & (before != now) & (before.notna() | now.notna())


def largest(both: pd.DataFrame, part: str) -> Iterator[str]:
    """Give a line a column, and a unit of scenes and blocks, with the largest difference."""
    for name in (own for own, allowed in COLUMNS[part].items() if allowed is not None):
        units = both.unit_now if "unit_now" in both else pd.Series("", both.index)
        for unit, most in apart(name, both).groupby(units).max().items():
            yield f"{part}, {name}{f' [{unit}]' if unit else ''}: at most {most:.1e} apart"


def differences(both: pd.DataFrame, part: str) -> Iterator[str]:
    """Give a line a row that differs."""
    found = pd.DataFrame({name: differ(name, both, allowed) for name, allowed in COLUMNS[part].items()})
    for index, row in both[found.any(axis=1)].iterrows():
        said = [f"{name} {row[f'{name}_before']} -> {row[f'{name}_now']}" for name in found if found[name][index]]
        yield f"{', '.join(row[NAMES[part]])}: {'; '.join(said)}"


def main(before: Path, now: Path) -> int:
    """Print what differs, and how many rows were compared; gives the exit code."""
    found, counts = [], pd.Series(0, ["both", "left_only", "right_only"])
    for part, names in NAMES.items():
        both = rows(before, part).merge(
            rows(now, part), how="outer", on=names, suffixes=("_before", "_now"), indicator="of"
        )
        counts += both.of.value_counts()
        if "both" in set(both.of):
            found += differences(both[both.of == "both"], part)
            print(*largest(both[both.of == "both"], part), sep="\n")
    print(*sorted(found), sep="\n")
    print(f"{counts.both} rows compared; {counts.left_only} only before, {counts.right_only} only now")
    print(f"{len(found)} differ")
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main(*map(Path, sys.argv[1:3])))
