"""What the exact preset of the reference runs: the motion between events in closed form."""

from collections.abc import Sequence
from typing import Any

from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.exact.event_driven import EventDrivenSimulation
from reference_lcp.exact.event_driven_system import EventDrivenBodies
from reference_lcp.one_call import SteadyState, exact_steady_state
from reference_lcp.schemes.sequential import SequentialSimulation


class ExactSimulation(EventDrivenSimulation):
    """The event-driven simulation, whose steady states are polished by Newton's method and read from their events."""

    def steady_states(self, steps_per_period: int) -> list[SteadyState]:
        """Give the steady state of every lane; see `SteadyStateSolver`."""
        drives: list[Any] = [lane.drive for lane in self.lanes]  # periodic ones
        return [
            exact_steady_state(lane.chain, drive, steps_per_period=steps_per_period)
            for lane, drive in zip(self.lanes, drives, strict=True)
        ]


def exact_simulation(lanes: Sequence[Lane]) -> Simulation:
    """Give the event-driven motion; with static friction above kinetic friction, without steady states."""
    if any(lane.static_ratio > 1 for lane in lanes):
        return SequentialSimulation([EventDrivenBodies(lane) for lane in lanes])
    return ExactSimulation(lanes)
