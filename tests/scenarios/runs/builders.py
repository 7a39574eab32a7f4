"""Tasks that tests of runs ask for, and the processes that they look at."""

import time
from collections.abc import Iterable
from pathlib import Path

from engines.interface.variant import Variant
from scenarios.runs.parameters import ChainRatios
from scenarios.runs.task import SteadyStateTask


def steady(
    frequency_ratio: float = 0.9, variant: Variant | str = "reference", cells: int = 2, **more
) -> SteadyStateTask:
    """Give a task of a short chain, with friction ratio 0.3 unless `more` says otherwise."""
    variant = Variant.parse(variant) if isinstance(variant, str) else variant
    usual = {"friction_ratio": 0.3, "ratios": ChainRatios(cells=cells)}
    return SteadyStateTask(variant=variant, frequency_ratio=frequency_ratio, **(usual | more))


def running(process: int) -> bool:
    """Whether a process is there, other than as an entry that nobody has read."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False


def ended(processes: Iterable[int], within: float) -> bool:
    """Whether all of these end within so many seconds."""
    left, until = list(processes), time.monotonic() + within
    while any(map(running, left)) and time.monotonic() < until:
        time.sleep(0.01)
    return not any(map(running, left))
