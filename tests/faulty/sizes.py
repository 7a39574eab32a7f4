"""How small a fault may be and still be found: engines with a fault of any size, and the bisection for it."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any
from unittest.mock import patch

from multibody_xval.engines.interface.registry import engine
from multibody_xval.scenarios.catalogue.finding import reasons_to_fail
from multibody_xval.scenarios.catalogue.scenario import Scenario
from multibody_xval.scenarios.model import Config
from reference_lcp.chain.drives import Drive
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.validation import FloatArray
from tests.scenarios.in_this_process import judged


@dataclass(frozen=True)
class AlteredDrive:
    """A drive whose load is that of the time (1 + `drift`) t − `delay` [s]."""

    drive: Drive
    delay: float = 0.0
    drift: float = 0.0

    def load(self, chain: Chain, time: FloatArray) -> FloatArray:
        return self.drive.load(chain, (1 + self.drift) * time - self.delay)

    def displacement_scale(self, chain: Chain) -> float:
        return self.drive.displacement_scale(chain)

    def parameters(self) -> dict[str, Any]:
        return self.drive.parameters()


@dataclass
class OfOtherLanes:
    """A simulation of other lanes than those that were given, and that says that it is of these."""

    simulation: Simulation
    lanes: tuple[Lane, ...]

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        runs = self.simulation.run(state, start, steps)
        return [replace(run, time=lane.times(start, steps)) for lane, run in zip(self.lanes, runs, strict=True)]

    def advance(self, state: State, start: int, steps: int) -> State:
        return self.simulation.advance(state, start, steps)

    def subset(self, lanes: Sequence[int]) -> "OfOtherLanes":
        return OfOtherLanes(self.simulation.subset(lanes), tuple(self.lanes[lane] for lane in lanes))

    def close(self) -> None:
        self.simulation.close()


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
        return OfOtherLanes(build(self, spoilt, formulation, preset), lanes)

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
