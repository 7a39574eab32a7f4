"""The Euler scheme for any batch of lanes."""

from collections.abc import Sequence

from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.stepping.euler_compiled import CompiledSimulation
from reference_lcp.stepping.euler_lemke import LemkeSimulation
from reference_lcp.stepping.inclined_lemke import InclinedLane
from reference_lcp.stepping.sequential import SequentialSimulation


def euler_simulation(lanes: Sequence[Lane]) -> Simulation:
    """Give the scheme of equation (5), compiled.

    With static friction above kinetic friction, or inclined contacts, it is that of equation (7) by Lemke's method.
    """
    if any(lane.inclination for lane in lanes):
        return SequentialSimulation([InclinedLane(lane) for lane in lanes])
    if any(lane.static_ratio > 1 for lane in lanes):
        return LemkeSimulation(tuple(lanes))
    return CompiledSimulation(lanes)
