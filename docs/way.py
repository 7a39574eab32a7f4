"""The way of one number from the file of a sweep to the page of its report, as the code goes it.

``python docs/way.py docs/_static/way.svg`` writes the report of a sweep of two points, in one process, and notes each
function of the suite that gives the transmittance of one of them, as a complex number or in dB, and each type of the
suite that holds it. It draws the functions in their order.
"""

import sys
import tempfile
from collections.abc import Iterable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from dataclasses import dataclass, field, fields, is_dataclass
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from multibody_xval.reports.page.write import write_page
from multibody_xval.scenarios import edges
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.model import Config
from multibody_xval.scenarios.running import evaluate
from multibody_xval.scenarios.running.evaluate import Means, computed
from multibody_xval.scenarios.running.processes import Job
from multibody_xval.scenarios.sweeps.file import read_sweep

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

OWN = Config("mujoco")
"""Whose number is followed, at the first frequency ratio."""


@dataclass
class Way:
    """The functions that give the number, and the types that hold it, in the order of their first time."""

    number: complex
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
        if isinstance(value, complex | float):
            found = value in (self.number, 20 * np.log10(abs(self.number)))
        elif isinstance(value, str):
            found = repr(self.number.real) in value
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
            return value.ravel().tolist() if value.size < MOST_NUMBERS and value.dtype.kind in "fcO" else ()
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


class InProcess:
    """A pool that does its jobs at once, in this process."""

    slots = 1

    def submit(self, job: Job) -> "Future[Any]":
        """Do a job."""
        done: Future[Any] = Future()
        done.set_result(job[0](*job[1]))
        return done

    def is_lost(self, serves: str) -> bool:
        """Nothing is ever on its way."""
        return False

    def give_up(self, serves: str) -> None:
        """Likewise."""


@contextmanager
def in_process(_: int) -> Iterator[InProcess]:
    """Give a pool of this process, in the place of worker processes."""
    yield InProcess()


def walked() -> Way:
    """Write the report of the sweep, with an eye on the number."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "sweep.toml").write_text(SWEEP, encoding="utf-8")
        sweep = read_sweep(folder / "sweep.toml")
        runs = sweep.runs()
        own = next(run for run in runs if run.config == OWN)
        way = Way(run_batch([own])[0].transmittance)
        sys.setprofile(way.look)
        try:
            found = computed(runs, Means(store=folder / "results.sqlite"), then=[("band edges", edges.propose)])
            write_page(found, folder / "report", "docs/way.py")
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
    evaluate.local = in_process  # type: ignore[assignment]
    found = walked()
    print(*found.functions, *counted(found), sep="\n")
    Path(sys.argv[1]).write_text(drawing(found), encoding="utf-8")
