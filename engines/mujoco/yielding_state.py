"""Springs that yield: their stiffness, and their deflection where a run begins, for MuJoCo and for its law."""

import numpy as np

from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.refusal import ParameterError
from reference_lcp.validation import FloatArray


def yield_stiffness(chain: Chain, time_step: float, phase: float) -> FloatArray:
    """Give k_s [N/m], shape (n,): a stuck contact oscillates by the angle `phase` in a step."""
    stiffness: FloatArray = (phase / time_step) ** 2 / (1 / chain.outer_mass + 1 / chain.inner_mass)
    return stiffness


def deflections_at(state: State, lane: Lane, start: int, stiffness: FloatArray) -> FloatArray:
    """Give the deflection x [m] of every spring, shape (n,), at most where it yields.

    Without a history a spring holds the load that it meets, and is bent by one step of the slip: unloaded, it would let
    go of a stuck contact, and ring.

    Parameters
    ----------
    state
        One lane; its internal state, if it has one, holds the deflections.
    lane, start
        The lane and the index of the first step.
    stiffness
        k_s [N/m], shape (n,).

    Raises
    ------
    ParameterError
        If the internal state is not one of such springs.
    """
    chain = lane.chain
    if state.internal_state is None:
        position, velocity = state.positions[0], state.velocities[0]
        pull = -chain.stiffness_matrix @ position - chain.damping_matrix @ velocity
        pull[0] += lane.loads(start, 1)[0]
        outer, inner = np.split(pull / np.diag(chain.mass_matrix), 2)
        holding = (inner - outer) / (1 / chain.outer_mass + 1 / chain.inner_mass)
        deflection = holding / stiffness + lane.time_step * (chain.contact_directions.T @ velocity)
    else:
        deflection = _checked(state.internal_state, chain.cells)[0]
    limit = chain.friction_bound / stiffness
    clipped: FloatArray = np.clip(deflection, -limit, limit)
    return clipped


def _checked(internal_state: FloatArray, cells: int) -> FloatArray:
    if internal_state.shape != (1, cells):
        raise ParameterError(
            f"the internal state of a lane has the shape {internal_state.shape}; allowed: {(1, cells)}"
        )
    return internal_state
