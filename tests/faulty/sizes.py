"""How small a fault may be and still be found: engines with a fault of any size, and the bisection for it."""

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from unittest.mock import patch

from multibody_xval.engines.interface.registry import engine
from multibody_xval.scenarios.catalogue.finding import reasons_to_fail
from multibody_xval.scenarios.catalogue.scenario import Scenario
from multibody_xval.scenarios.model import Config
from reference_lcp.chain.simulation import Lane
from tests.mutations.altered import AlteredSimulation
from tests.mutations.errors import AlteredDrive
from tests.scenarios.in_this_process import judged

Change = Callable[[Lane, float], Lane]
"""Gives a lane with a fault of a size."""

SMALLEST, LARGEST = 1e-8, 1e-1
"""Sizes that are tried."""

WITHIN = 1.3
"""Factor to which the smallest size is told."""


def _times(name: str) -> Change:
    """Let a parameter of the chain be 1 + s times what it is."""
    return lambda lane, size: replace(lane, chain=replace(lane.chain, **{name: (1 + size) * getattr(lane.chain, name)}))


def _long_steps(lane: Lane, size: float) -> Lane:
    """Let steps be 1 + s times as long, and the drive as it is at the steps that are asked for."""
    return replace(
        lane, time_step=(1 + size) * lane.time_step, drive=AlteredDrive(lane.drive, drift=-size / (1 + size))
    )


def _late_base(lane: Lane, size: float) -> Lane:
    """Let the base be late by a part of the period; of a drive without one, of the time of 400 steps."""
    period = getattr(lane.drive, "period", 400 * lane.time_step)
    return replace(lane, drive=AlteredDrive(lane.drive, delay=size * period))


SIZED: Mapping[str, Change] = {
    "mass": _times("outer_mass"),
    "bound": _times("friction_coefficient"),
    "spring": _times("inner_stiffness"),
    "step": _long_steps,
    "time of the base": _late_base,
}
"""Faults of any size, as parts: of the number itself, and of the period for the time of the base."""


@contextmanager
def wrong_by(config: Config, fault: str, size: float) -> Iterator[None]:
    """Let an engine build lanes with a fault, and say that they are those that were given."""
    kind = type(engine(config.engine))
    build = kind._build

    def wrong(self, lanes, formulation, preset):
        spoilt = tuple(SIZED[fault](lane, size) for lane in lanes)
        return AlteredSimulation(build(self, spoilt, formulation, preset), lanes)

    with patch.object(kind, "_build", wrong):
        yield


def is_noticed(scenario: Scenario, config: Config, fault: str, size: float) -> bool:
    """Whether ``run`` fails by the fault."""
    with wrong_by(config, fault, size):
        return bool(reasons_to_fail(judged(scenario, config), named=True))


def smallest_noticed(scenario: Scenario, config: Config, fault: str) -> float:
    """Give the smallest size that is noticed, by bisection; infinite where none is, zero where every one is."""
    if not is_noticed(scenario, config, fault, LARGEST):
        return math.inf
    if is_noticed(scenario, config, fault, SMALLEST):
        return 0.0
    low, high = SMALLEST, LARGEST
    while high / low > WITHIN:
        middle = math.sqrt(low * high)
        low, high = (low, middle) if is_noticed(scenario, config, fault, middle) else (middle, high)
    return high
