"""How small a fault may be and still be noticed: ``python -m tests.faulty.sizes`` prints docs/noticed.md's table."""

import math
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from unittest.mock import patch

from multibody_xval.engines.interface.registry import engine
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.finding import reasons_to_fail
from multibody_xval.scenarios.catalogue.scenario import Scenario
from multibody_xval.scenarios.model import Config
from reference_lcp.validation import FloatArray
from tests.faulty.faults import numbers
from tests.faulty.scheme import Batch, Fault
from tests.scenarios.in_this_process import judged
from tests.site import Site

SMALLEST, LARGEST = 1e-10, 1e-1
"""Sizes that are tried."""

WITHIN = 1.5
"""Factor to which the smallest size is told."""

ENGINE, PRESETS = "faulty-sound", {"tuned": "the reference at equal steps", "other": "the exact motion"}
"""The engine that gets a fault, and what its presets are compared with."""

ASKED = ("unit-cell", "disordered-chain", "free-decay", "breakaway", "stopping-distance")
"""Scenarios of the table."""


def _period(batch: Batch) -> FloatArray:
    """Give the period of every lane; of a drive without one, the time of 400 steps."""
    return batch.step * [[getattr(lane.drive, "period", 400 * lane.time_step) / lane.time_step] for lane in batch.lanes]


def _of_chain(name: str) -> Callable[[float], Fault]:
    return lambda size: Fault(name, chain={name: 1 + size})


SIZED: Mapping[str, Callable[[float], Fault]] = {
    "mass": _of_chain("outer_mass"),
    "bound": _of_chain("friction_coefficient"),
    "spring": _of_chain("inner_stiffness"),
    "step": lambda size: Fault("step", batch=numbers(step=lambda of: (1 + size) * of.step)),
    "time of the base": lambda size: Fault("time", batch=numbers(delay=lambda of: size * _period(of))),
}
"""Faults of any size, as parts: of the number itself, and of the period for the time of the base."""


@contextmanager
def wrong_by(fault: Fault) -> Iterator[None]:
    """Let the sound engine have a fault."""
    build = lambda _self, lanes, _formulation, preset: Batch(lanes, fault, preset)  # noqa: E731
    with patch.object(type(engine(ENGINE)), "_build", build):
        yield


def is_noticed(scenario: Scenario, preset: str, fault: str, size: float) -> bool:
    """Whether ``run`` fails by the fault."""
    with wrong_by(SIZED[fault](size)):
        return bool(reasons_to_fail(judged(scenario, Config(ENGINE, preset_name=preset)), named=True))


def smallest_noticed(scenario: Scenario, preset: str, fault: str) -> float:
    """Give the smallest size that is noticed, by bisection; infinite where none is, zero where every one is."""
    if not is_noticed(scenario, preset, fault, LARGEST):
        return math.inf
    if is_noticed(scenario, preset, fault, SMALLEST):
        return 0.0
    low, high = SMALLEST, LARGEST
    while high / low > WITHIN:
        middle = math.sqrt(low * high)
        low, high = (low, middle) if is_noticed(scenario, preset, fault, middle) else (middle, high)
    return high


def _text(size: float) -> str:
    return "not noticed" if size == math.inf else f"{size:.1e}" if size else f"≤ {SMALLEST:.0e}"


def print_table() -> None:
    """Print the smallest sizes in Markdown, row by row."""
    print("| scenario | compared with |", " | ".join(SIZED), "|")
    print("|---|---|", "---|" * len(SIZED), sep="")
    for name in ASKED:
        for preset, beside in PRESETS.items():
            sizes = [_text(smallest_noticed(SCENARIOS[name], preset, fault)) for fault in SIZED]
            print(f"| {name} | {beside} |", " | ".join(sizes), "|", flush=True)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder, Site(Path(folder), "faulty").visible():
        print_table()
