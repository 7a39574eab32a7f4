"""The way of one number from the file of a sweep to the page of its report, as the code goes it.

``python docs/way.py docs/_static/way.svg`` runs a sweep of two points twice, and notes each function of the suite that
gives the transmittance of one of them, and each type of the suite that holds it. It draws the functions in their order.
"""

import sys
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass, field, fields, is_dataclass
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from multibody_xval.reports.data.collect import Scope
from multibody_xval.reports.write import write_sweep_report
from multibody_xval.scenarios.runs.executor import InProcessExecutor
from multibody_xval.scenarios.sweeps.spec_file import read_sweep

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("reference_lcp", "multibody_xval")
DEPTH, MOST_NUMBERS = 7, 10_000
"""Containers in containers that are looked into, and numbers of an array."""

ROW, MOST = 21, 62
"""Height of a row [px], and letters of its names."""

COLOURS = {"reference_lcp": "#e3ecf5", "engines": "#f5ece0", "scenarios": "#e6f2e6", "reports": "#f3e6ee"}

SWEEP = """
engines = ["reference", "mujoco"]
[grid]
friction_ratio = [0.3]
frequency_ratio = [0.9, 1.1]
"""

POINTS = Scope((), (0.3,), (0.9, 1.1), (), checked=0)
"""The points of the sweep alone, with what their verdicts need."""


@dataclass
class Way:
    """The functions that give the number, and the types that hold it, in the order of their first time."""

    number: float
    functions: dict[str, None] = field(default_factory=dict)
    containers: dict[str, None] = field(default_factory=dict)
    _without: dict[int, Any] = field(default_factory=dict)

    def look(self, frame: FrameType, event: str, given: Any) -> None:
        """Note a function of the suite that returns the number; a profiler of Python calls this."""
        if event != "return" or given is None or isinstance(given, bool | int | Path):
            return
        file = Path(frame.f_code.co_filename)
        if frame.f_code.co_name.startswith("<") or not file.is_relative_to(ROOT):
            return
        place = file.resolve().relative_to(ROOT)
        if place.parts[0] in COLOURS and self._holds(given, DEPTH, ()):
            self.functions.setdefault(f"{place.with_suffix('')}:{frame.f_code.co_qualname}", None)

    def _holds(self, value: Any, depth: int, within: tuple[str, ...]) -> bool:
        """Say whether a value is the number or holds it, and note the types of the suite around it."""
        if isinstance(value, float):
            found = value == self.number
        elif isinstance(value, str):
            found = repr(self.number) in value
        elif depth == 0 or id(value) in self._without:
            found = False
        else:
            kind = type(value)
            own = (kind.__name__,) if kind.__module__.split(".")[0] in PACKAGES else ()
            found = any(self._holds(part, depth - 1, (*within, *own)) for part in parts(value))
            if not found and depth == DEPTH:
                self._without[id(value)] = value  # which keeps it alive, and its identity its own
            return found
        if found:
            self.containers.update(dict.fromkeys(within))
        return found


def parts(value: Any) -> Iterable[Any]:
    """Give what a container holds: of arrays and tables numbers, of records their fields."""
    match value:
        case np.ndarray():
            return value.ravel().tolist() if value.size < MOST_NUMBERS and value.dtype.kind in "fO" else ()
        case pd.DataFrame():
            return [cell for column in value for cell in value[column].tolist()]
        case xr.Dataset():
            return [variable.values for variable in value.variables.values()]
        case dict():
            return value.values()
        case tuple() | list():
            return value
    names = [one.name for one in fields(value)] if is_dataclass(value) else getattr(value, "__dict__", ())
    return [getattr(value, name, None) for name in names] if type(value).__module__.split(".")[0] in PACKAGES else ()


def walked() -> Way:
    """Run the sweep, and again with an eye on the number."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "sweep.toml").write_text(SWEEP, encoding="utf-8")
        sweep = read_sweep(folder / "sweep.toml").with_reference()

        def write(into: str) -> None:
            write_sweep_report(sweep, folder / into, "docs/way.py", executor=InProcessExecutor(), scope=POINTS)

        write("first")
        with xr.open_dataset(folder / "first" / "report.nc") as data:
            chosen = data.transmittance_db.sel(variant="mujoco", drop=True)
            way = Way(float(chosen.values.ravel()[0]))
        sys.setprofile(way.look)
        try:
            write("second")
        finally:
            sys.setprofile(None)
    return way


def drawing(way: Way) -> str:
    """Draw the functions in their order, those of one file that follow each other in one row."""
    places = [one.split(":") for one in way.functions]
    rows = [(file, [name for _, name in group]) for file, group in groupby(places, itemgetter(0))]
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 760 {ROW * (len(rows) + 3)}" role="img">',
        "<style>text{font:13px sans-serif;fill:#222}.file{font-weight:600}</style>",
        f'<rect width="760" height="{ROW * (len(rows) + 3)}" fill="#fff"/>',
    ]
    for number, (file, names) in enumerate(rows):
        y, room = ROW * (number + 1), file.split("/")[0]
        lines.append(f'<rect x="8" y="{y - 15}" width="744" height="{ROW - 3}" rx="3" fill="{COLOURS[room]}"/>')
        lines.append(f'<text class="file" x="14" y="{y}">{file}</text>')
        shown = " → ".join(name.rsplit(".", 1)[-1] for name in names)
        lines.append(f'<text x="330" y="{y}">{shown if len(shown) < MOST else shown[:MOST] + " …"}</text>')
    for number, line in enumerate(counted(way)):
        lines.append(f'<text x="14" y="{ROW * (len(rows) + 1 + number)}">{line}</text>')
    return "\n".join([*lines, "</svg>"]) + "\n"


def counted(way: Way) -> tuple[str, str]:
    """Say how many functions and files there are, and which types of the suite."""
    files = {one.split(":")[0] for one in way.functions}
    types = ", ".join(way.containers)
    return f"{len(way.functions)} functions in {len(files)} files.", f"{len(way.containers)} types hold it: {types}"


if __name__ == "__main__":
    found = walked()
    print(*found.functions, *counted(found), sep="\n")
    Path(sys.argv[1]).write_text(drawing(found), encoding="utf-8")
