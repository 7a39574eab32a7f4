"""The internal state of bristles between runs, which Exudyn and its model share."""

import numpy as np

from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.validation import FloatArray


def bristles_at(
    state: State, lane: Lane, load: float, stiffness: FloatArray, damping: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Give slip forces, 0 in stick, and deflections of the bristles, shape (n,) each, in the units of what is given.

    Parameters
    ----------
    state
        One lane; its internal state, if it has one, holds both.
    lane
        The lane.
    load
        Force on cell 1.
    stiffness, damping
        Of the bristles and of the dashpots beside them, shape (n,).
    """
    if state.internal_state is None:
        return _fresh_bristles(state, lane, load, stiffness, damping)
    slip, deflection = np.split(state.internal_state[0], 2)
    return _nearest_slip(slip, lane.chain.friction_bound), deflection


def _nearest_slip(slip: FloatArray, bound: FloatArray) -> FloatArray:
    """Slip forces that a bristle can have, 0 or ±μN: a search of periodic orbits mixes those of several periods."""
    return np.where(np.abs(slip) > bound / 2, np.copysign(bound, slip), 0.0)


def _fresh_bristles(
    state: State, lane: Lane, load: float, stiffness: FloatArray, damping: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Slip forces and deflections without a history: each bristle holds the load that it meets.

    A bristle that started unloaded would let go of a stuck contact and ring.
    """
    chain, position, velocity = lane.chain, state.positions[0], state.velocities[0]
    pull = -chain.stiffness_matrix @ position - chain.damping_matrix @ velocity
    pull[0] += load
    outer, inner = np.split(pull / np.diag(chain.mass_matrix), 2)
    holding = (inner - outer) / (1 / chain.outer_mass + 1 / chain.inner_mass)
    force = holding + damping * (chain.contact_directions.T @ velocity)
    slips = np.abs(force) >= lane.static_ratio * chain.friction_bound
    return np.where(slips, np.copysign(chain.friction_bound, force), 0.0), np.where(slips, 0.0, holding / stiffness)
