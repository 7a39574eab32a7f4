"""How far an engine is from its law after one period from the same state."""

from dataclasses import dataclass

import numpy as np

from engines.interface.law import Law
from engines.interface.registry import engine
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.chain.trajectory import State, Trajectory

APPROACH_PERIODS = 10
"""Periods from rest that the law leads to the state from which both start: stick and slip are then as they will be."""


@dataclass(frozen=True)
class LawDistance:
    """Largest differences of positions over a period from the same state, over the displacement scale.

    Parameters
    ----------
    law
        Of the engine from its law.
    reference
        Of the engine from the reference.
    """

    law: float
    reference: float


def distance_from_law(simulation: Simulation, law: Law, lane: Lane, steps: int) -> LawDistance:
    """Compare a period of an engine with its law's, from the same state.

    Parameters
    ----------
    simulation
        The engine with this lane alone.
    law, lane, steps
        Its law, the lane, and the number of steps of a period.
    """
    model = law.build([lane])
    state = model.advance(State.at_rest(1, lane.chain.cells), 0, APPROACH_PERIODS * steps)
    own, predicted, reference = (
        _period(each, state, steps) for each in (simulation, model, engine("reference").build([lane]))
    )
    scale = lane.drive.displacement_scale(lane.chain)
    return LawDistance(
        *(float(np.max(np.abs(own.positions - run.positions))) / scale for run in (predicted, reference))
    )


def _period(simulation: Simulation, state: State, steps: int) -> Trajectory:
    """Advance by a period from a whole number of them; the reference has no internal state."""
    try:
        return simulation.run(state, 0, steps)[0]
    finally:
        simulation.close()
