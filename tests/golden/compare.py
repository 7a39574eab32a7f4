"""Compares two folders that `tests.golden.record` wrote: ``python -m tests.golden.compare BEFORE NOW``.

It prints a line a difference, and ends with 1 if there is any. Rows of engines and presets that only one of the two
folders has are counted, not compared: an engine may not be installed.
"""

import csv
import math
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

Row = Mapping[str, str]

ROUND_OFF = 1e-7
"""Relative difference of numbers that another processor computes: sums take other orders there."""

WRITTEN_DB, WRITTEN_DEG = 1e-7, 1e-4
"""What the digits of a file leave open of a level [dB] and a phase [deg]."""

RESOLUTION = {"µm/s": 0.1, "µrad/s": 0.1, "mm": 1e-3, "mrad": 1e-3, "°": 1e-3, "%": 1e-3, "in η_r": 1e-6}
"""Differences of scenes and blocks that count as none, by unit: creep has a resolution of 0.1 µm/s."""

PHASE_OF_DB = math.degrees(math.log(10) / 20)
"""Phase [deg] that is left open where this level [dB] is: both are parts of one complex number."""


def number(row: Row, name: str) -> float:
    """Read a number; NaN where there is none."""
    return float(row[name]) if row[name] else math.nan


def apart(before: float, now: float, allowed: float) -> bool:
    """Whether two numbers differ; two that are missing do not."""
    if math.isnan(before) and math.isnan(now):
        return False
    return not abs(before - now) <= allowed + ROUND_OFF * abs(before)


def steady(before: Row, now: Row) -> str:
    """Say how two steady states differ beyond what their residuals leave open."""
    if before["status"] != now["status"]:
        return f"status {before['status']} -> {now['status']}"
    if before["status"] != "periodic":
        return ""
    left = number(before, "open_db") + number(now, "open_db") + WRITTEN_DB
    if apart(number(before, "level_db"), number(now, "level_db"), left):
        return f"level {before['level_db']} -> {now['level_db']} dB, open {left:.1e}"
    turn = (number(now, "phase_deg") - number(before, "phase_deg") + 180) % 360 - 180
    if abs(turn) > left * PHASE_OF_DB + WRITTEN_DEG:
        return f"phase {before['phase_deg']} -> {now['phase_deg']} deg"
    names = ("stuck", "transitions")
    return ", ".join(f"{name} {before[name]} -> {now[name]}" for name in names if before[name] != now[name])


def scenario(before: Row, now: Row) -> str:
    """Say how two numbers of a block or a scene differ."""
    allowed = RESOLUTION.get(before["unit"], ROUND_OFF)
    differs = apart(number(before, "value"), number(now, "value"), allowed)
    return f"{before['value'] or 'no number'} -> {now['value'] or 'no number'} {before['unit']}" if differs else ""


def edge(before: Row, now: Row) -> str:
    """Say how two edges differ beyond the widths to which they are bracketed."""
    names = ("frequency_ratio", "width")
    (one, width), (other, own) = ([number(row, name) for name in names] for row in (before, now))
    return f"{one} -> {other}" if apart(one, other, width + own) else ""


def reference(before: Row, now: Row) -> str:
    """Say how two answers of the reference differ; proven digits are compared as they are."""
    if before["proven_db"] != now["proven_db"]:
        return f"proven {before['proven_db']} -> {now['proven_db']} dB"
    names = {"level_db": WRITTEN_DB, "phase_deg": WRITTEN_DEG, "error_bar_db": WRITTEN_DB, "exact_db": WRITTEN_DB}
    differing = [name for name, own in names.items() if apart(number(before, name), number(now, name), own)]
    differing += [name for name in ("stuck", "transitions") if before[name] != now[name]]
    return ", ".join(f"{name} {before[name]} -> {now[name]}" for name in differing)


Compare = Callable[[Row, Row], str]

FILES: Mapping[str, tuple[tuple[str, ...], Compare]] = {
    "steady/*.csv": (("config", "point"), steady),
    "scenarios/*.csv": (("scenario", "case", "config", "quantity"), scenario),
    "edges.csv": (("config", "friction_ratio", "edge"), edge),
    "reference.csv": (("point",), reference),
}
"""Files by pattern: the columns that name a row, and what compares two rows."""


def rows(folder: Path, pattern: str, names: tuple[str, ...]) -> dict[tuple[str, ...], Row]:
    """Give the rows of files by what names them."""
    found: dict[tuple[str, ...], Row] = {}
    for path in sorted(folder.glob(pattern)):
        with path.open(newline="", encoding="utf-8") as file:
            found |= {tuple(row[name] for name in names): row for row in csv.DictReader(file)}
    return found


def differences(before: Path, now: Path) -> Iterator[str]:
    """Give a line a row that differs."""
    for pattern, (names, compare) in FILES.items():
        one, other = rows(before, pattern, names), rows(now, pattern, names)
        for name in one.keys() & other.keys():
            if said := compare(one[name], other[name]):
                yield f"{', '.join(name)}: {said}"


def counts(before: Path, now: Path) -> str:
    """Say how many rows were compared, and how many only one of the two folders has."""
    names = [(rows(before, pattern, own).keys(), rows(now, pattern, own).keys()) for pattern, (own, _) in FILES.items()]
    both, gone, new = (sum(map(len, own)) for own in zip(*((a & b, a - b, b - a) for a, b in names), strict=True))
    return f"{both} rows compared; {gone} only before, {new} only now"


def main(before: Path, now: Path) -> int:
    """Print what differs; gives the exit code."""
    found = sorted(differences(before, now))
    print(*found, counts(before, now), f"{len(found)} differ", sep="\n")
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main(*map(Path, sys.argv[1:3])))
