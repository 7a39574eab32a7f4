"""How far an engine is from what it states, its law or the reference's step, after one period from the same state."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from multibody_xval.engines.interface.engine import Engine
from multibody_xval.engines.interface.law import Law
from multibody_xval.engines.interface.registry import engine, law_of
from multibody_xval.engines.interface.tolerances import CREEP, TRAJECTORY_TOLERANCE
from multibody_xval.engines.interface.variant import Variant
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.defaults import BASE_AMPLITUDE, MINIMUM_STEPS_PER_PERIOD
from reference_lcp.errors import shortened

FRICTION_RATIOS, FREQUENCY_RATIOS = (0.1, 0.3, 1.0), (0.5, 0.7, 0.9, 1.1, 1.3, 1.5)
"""The points of figure 3 at which engine and law are compared."""

LONGEST_FAILURE = 200
"""Characters of an error of an engine."""

APPROACH_PERIODS = 10
"""Periods from rest that the law leads to the state from which both start: stick and slip are then as they will be."""


@dataclass(frozen=True)
class LawDistance:
    """Largest differences of positions over a period from the same state, over the displacement scale."""

    law: float
    """Of the engine from its law, or from the reference's step where it takes that."""
    reference: float
    """Of the engine from the reference."""


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
    """Compare a period of an engine that has this lane alone with one of what it states, see `stepped_by`."""
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


def figure3_lanes() -> list[Lane]:
    """Give the chain of figure 3 at every point at which engine and law are compared."""
    lanes = []
    for friction_ratio in FRICTION_RATIOS:
        chain = Chain.from_ratios(friction_ratio=friction_ratio)
        for frequency_ratio in FREQUENCY_RATIOS:
            base = HarmonicBase.from_ratio(chain, frequency_ratio, BASE_AMPLITUDE)
            lanes.append(Lane.periodic(chain, base, MINIMUM_STEPS_PER_PERIOD))
    return lanes


def difference_in_words(variant: Variant, law: Law, lanes: Sequence[Lane]) -> str:
    """Say how far an engine is from its law and from the reference, at most; or that one of them fails."""
    try:
        distances = [distance_from_law(variant.build([lane]), law, lane, MINIMUM_STEPS_PER_PERIOD) for lane in lanes]
    except Exception as problem:  # an engine may raise anything
        text = shortened(" ".join(f"{type(problem).__name__}: {problem}".split()), LONGEST_FAILURE)
        return f"not measured: engine or law fails with {text}"
    own, reference = (float(np.max([getattr(each, name) for each in distances])) for name in ("law", "reference"))
    if math.isfinite(own):
        text = f"at most {own:.2g} U0 from its law, {reference:.2g} U0 from the reference"
    else:
        text = "the engine's positions are not finite"
    return f"after a period from the same state, at {len(lanes)} points: {text}"
