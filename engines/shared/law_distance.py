"""How far an engine is from what it states, its law or the reference's step, after one period from the same state."""

from dataclasses import dataclass

import numpy as np

from engines.interface.engine import Engine
from engines.interface.law import Law
from engines.interface.law_engine import law_of
from engines.interface.registry import engine
from engines.interface.tolerances import CREEP, TRAJECTORY_TOLERANCE
from engines.interface.variant import Variant
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
        Of the engine from its law, or from the reference's step where it takes that.
    reference
        Of the engine from the reference.
    """

    law: float
    reference: float


def stepped_by(variant: Variant) -> Engine | Law | None:
    """Give what a variant states that it steps by: the reference, or its law; ``None`` where that is not modelled."""
    return engine("reference") if variant.preset.shares_scheme else law_of(variant.preset)


def unclaimed_reason(law: Engine | Law, lane: Lane) -> str | None:
    """Give the reason why a law does not say how an engine steps a lane; the reference's scheme does for every lane."""
    return law.unclaimed_reason(lane) if isinstance(law, Law) else None


def allowed_distance(variant: Variant) -> float:
    """Largest distance of a variant from what it steps by, after a period, over the displacement scale."""
    law = law_of(variant.preset)
    if law is not None:
        return law.period_bound
    return TRAJECTORY_TOLERANCE[variant.capabilities.precision] + CREEP * variant.preset.residual_slip_compliance


def distance_from_law(simulation: Simulation, law: Engine | Law, lane: Lane, steps: int) -> LawDistance:
    """Compare a period of an engine with its law's, from the same state.

    Parameters
    ----------
    simulation
        The engine with this lane alone.
    law, lane, steps
        What it steps by, see `stepped_by`; the lane; the number of steps of a period.
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
