"""A simulation with something wrong around it: other lanes than given, other records, other starts."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.chain.trajectory import State, Trajectory
from tests.mutations.mutant import Original

Built = Callable[[Original, tuple[Lane, ...], float], Simulation]


@dataclass
class AlteredSimulation:
    """A simulation that is altered where states go in, and where trajectories come out."""

    simulation: Simulation
    """What advances the lanes, perhaps other ones."""
    lanes: tuple[Lane, ...]
    """The lanes that were given."""
    state: Callable[[State], State] = lambda state: state
    start: Callable[[int], int] = lambda start: start
    """Give the state and the step index from which `simulation` begins."""
    record: Callable[[Trajectory], Trajectory] = lambda trajectory: trajectory
    """Gives what is recorded of a trajectory of `simulation` in a lane."""

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane; see `Simulation.run`."""
        runs = self.simulation.run(self.state(state), self.start(start), steps)
        return [
            replace(self.record(run), time=lane.times(start, steps)) for lane, run in zip(self.lanes, runs, strict=True)
        ]

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance every lane, keep the final state; see `Simulation.advance`."""
        return self.simulation.advance(self.state(state), self.start(start), steps)

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> "AlteredSimulation":
        """Give the lanes of these indices."""
        return replace(self, simulation=self.simulation.subset(lanes), lanes=tuple(self.lanes[lane] for lane in lanes))

    def close(self) -> None:
        """Free what `simulation` holds."""
        self.simulation.close()


def of_lanes(change: Callable[[Lane, float], Lane]) -> Built:
    """Build other lanes than those that were given."""

    def build(original: Original, lanes: tuple[Lane, ...], size: float) -> AlteredSimulation:
        return AlteredSimulation(original.build([change(lane, size) for lane in lanes]), lanes)

    return build


def of_chains(**changes: Callable[[Chain, float], Any]) -> Built:
    """Build chains of other parameters, by their names, than those that were given."""

    def change(lane: Lane, size: float) -> Lane:
        values = {name: value(lane.chain, size) for name, value in changes.items()}
        return replace(lane, chain=replace(lane.chain, **values))

    return of_lanes(change)


def of_records(change: Callable[[Trajectory, float], Trajectory]) -> Built:
    """Record something else than what moves."""

    def build(original: Original, lanes: tuple[Lane, ...], size: float) -> AlteredSimulation:
        return AlteredSimulation(original.build(lanes), lanes, record=lambda run: change(run, size))

    return build
