"""Steps of several substeps under the forces of the step's start, with friction solved anew in each of them."""

import numpy as np

from multibody_xval.engines.interface.laws import Step
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray


def substep_law(lane: Lane, count: int, *, friction_late: bool = False) -> Step:
    """Give the step of a lane, of `count` substeps; late friction is found after positions have moved."""
    chain, h = lane.chain, lane.time_step / count
    directions, inverse = chain.contact_directions, 1 / np.diag(chain.mass_matrix)
    stopping = 1 / (1 / chain.outer_mass + 1 / chain.inner_mass) / h

    def substeps(
        position: FloatArray, velocity: FloatArray, force: FloatArray, bound: FloatArray, friction: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Give positions, velocities and friction after the last one from those before the first one."""
        for _ in range(count):
            velocity = velocity + h * inverse * force
            if friction_late:
                position = position + h * (velocity + h * inverse * (directions @ friction))
            friction = np.clip(-stopping * (velocity @ directions), -bound, bound)
            velocity = velocity + h * inverse * (directions @ friction)
            if not friction_late:
                position = position + h * velocity
        return position, velocity, friction

    last: FloatArray | None = None

    def take(
        position: FloatArray, velocity: FloatArray, load: FloatArray, bound: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        nonlocal last
        force = -chain.stiffness_matrix @ position - chain.damping_matrix @ velocity
        force[0] += load[0]
        if last is None:
            last = substeps(position, velocity, force, bound, np.zeros(chain.cells))[2]
        position, velocity, last = substeps(position, velocity, force, bound, last)
        return position, velocity

    return take
