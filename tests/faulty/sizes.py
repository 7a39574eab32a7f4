"""How small a fault may be and still be noticed: ``python -m tests.faulty.sizes`` prints a table of docs."""

import tempfile
from bisect import bisect_left
from collections.abc import Callable, Mapping
from pathlib import Path
from unittest.mock import patch

import numpy as np

from multibody_xval.engines.interface.registry import engine
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.finding import reasons_to_fail
from multibody_xval.scenarios.model import Config
from reference_lcp.validation import FloatArray
from tests.faulty.scheme import Batch, Fault
from tests.scenarios.in_this_process import judged
from tests.site import Site

SIZES = np.geomspace(1e-10, 0.1, 46)
"""Sizes that are tried, five a decade."""

ENGINE, PRESETS = "faulty-sound", {"tuned": "the reference at equal steps", "other": "the exact motion"}
"""The engine that gets a fault, and what its presets are compared with."""

ASKED = ("unit-cell", "disordered-chain", "free-decay", "breakaway", "stopping-distance")
"""Scenarios of the table."""


def _period(batch: Batch) -> FloatArray:
    """Give the period of every lane; of a drive without one, the time of 400 steps."""
    return batch.step * [[getattr(lane.drive, "period", 400 * lane.time_step) / lane.time_step] for lane in batch.lanes]


SIZED: Mapping[str, Callable[[float], Fault]] = {
    "mass": lambda size: Fault("mass", chain={"outer_mass": 1 + size}),
    "bound": lambda size: Fault("bound", chain={"friction_coefficient": 1 + size}),
    "spring": lambda size: Fault("spring", chain={"inner_stiffness": 1 + size}),
    "step": lambda size: Fault("step", numbers={"step": lambda of: (1 + size) * of.step}),
    "time of the base": lambda size: Fault("time", numbers={"delay": lambda of: size * _period(of)}),
}
"""Faults of any size, as parts: of the number itself, and of the period for the time of the base."""


def is_noticed(scenario: str, preset: str, fault: str, size: float) -> bool:
    """Whether ``run`` fails by the fault in an engine that is sound otherwise."""
    wrong = SIZED[fault](size)
    build = lambda _self, lanes, _formulation, preset: Batch(lanes, wrong, preset)  # noqa: E731
    with patch.object(type(engine(ENGINE)), "_build", build):
        return bool(reasons_to_fail(judged(SCENARIOS[scenario], Config(ENGINE, preset_name=preset)), named=True))


def smallest_noticed(scenario: str, preset: str, fault: str) -> str:
    """Give the smallest size that is noticed: larger ones are noticed, too."""
    first = bisect_left(SIZES, True, key=lambda size: is_noticed(scenario, preset, fault, size))
    if first == len(SIZES):
        return "not found"
    return f"{SIZES[first]:.1e}" if first else f"≤ {SIZES[0]:.0e}"


def print_table() -> None:
    """Print the smallest sizes in Markdown, row by row."""
    print("| scenario | compared with |", " | ".join(SIZED), "|")
    print("|---|---|", "---|" * len(SIZED), sep="")
    for name in ASKED:
        for preset, beside in PRESETS.items():
            sizes = [smallest_noticed(name, preset, fault) for fault in SIZED]
            print(f"| {name} | {beside} |", " | ".join(sizes), "|", flush=True)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder, Site(Path(folder), "faulty").visible():
        print_table()
