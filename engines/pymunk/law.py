"""The law of Chipmunk's damped springs: positions first, then springs, then sweeps over frictions and dashpots."""

import numpy as np

from multibody_xval.engines.interface.laws import Law, Step
from multibody_xval.engines.interface.presets import Preset
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray


def damped_springs(preset: Preset) -> Law:
    """Give the law of damped springs; it has no constants beside the chain's."""
    sweeps = preset["iterations"]
    return Law(
        formula=(
            "q⁺ = q + h q̇; q̇ ← q̇ + h M⁻¹ (f(t) e_1 − K q⁺); "
            f"then {sweeps} sweeps: every friction impulse to rest, in sum within ±h μ λ_N, then every dashpot, c_c "
            "before c_i: d = (r_0 − r)(1 − exp(−c h A)) on its rate r, r_0 ← r + d, r_0 = 0 at first, "
            "A the sum of the inverse masses at its ends"
        ),
        step=lambda lane, _: _step(lane, sweeps),
    )


def _step(lane: Lane, sweeps: int) -> Step:
    chain, h, inverse = lane.chain, lane.time_step, 1 / np.diag(lane.chain.mass_matrix)
    cells, directions = chain.cells, chain.contact_directions
    # What a dashpot and a contact do to all velocities where they change their own rate by one.
    rates = np.vstack([np.eye(cells, 2 * cells) - np.eye(cells, 2 * cells, -1), directions.T])
    mobilities = np.einsum("ij,j,ij->i", rates, inverse, rates)
    responses = rates * inverse / mobilities[:, None]
    parts = 1 - np.exp(-np.concatenate([chain.chain_damping, chain.inner_damping]) * h * mobilities)

    def take(
        position: FloatArray, velocity: FloatArray, load: FloatArray, bound: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        position = position + h * velocity
        force = -chain.stiffness_matrix @ position
        force[0] += load[0]
        velocity, friction, target = velocity + h * inverse * force, np.zeros(cells), np.zeros(2 * cells)
        for _ in range(sweeps):
            stopped = friction - directions.T @ velocity / mobilities[cells:]
            total = np.clip(stopped, -h * bound, h * bound)
            velocity += inverse * (directions @ (total - friction))
            friction = total
            for dashpot in range(2 * cells):
                rate = rates[dashpot] @ velocity
                change = (target[dashpot] - rate) * parts[dashpot]
                target[dashpot] = rate + change
                velocity += change * responses[dashpot]
        return position, velocity

    return take


LAWS = {
    "joint:recommended": damped_springs,
    "joint:default": damped_springs,
    "contact:recommended": damped_springs,
    "contact:default": damped_springs,
}
"""By formulation and preset."""
