"""The law of Rapier's substeps: forces of the start of a step, and friction solved anew in every part of it."""

import numpy as np

from multibody_xval.engines.interface.laws import Law, Step
from multibody_xval.engines.interface.presets import Preset
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray

SINGLE_PRECISION_PERIOD = 6e-5
"""Of U0: positions and velocities, of some U0 and U0 ω, are rounded by 2^-24 in each of 1,600 substeps. Roundings add
up as the root of their number: three standard deviations for motions of up to eight U0."""


def motor_substeps(preset: Preset) -> Law:
    """Give the law of motors, whose impulses are found before positions move."""
    formula = "q̇ ← q̇ + M⁻¹ (h F + W p), |p| ≤ h μ λ_N by Coulomb's law; q ← q + h q̇"
    return _substeps(preset, formula, friction_late=False)


def contact_substeps(preset: Preset) -> Law:
    """Give the law of contacts, whose friction is found after positions have moved."""
    formula = (
        "q ← q + h (q̇ + M⁻¹ (h F + W p)) with p of the substep before, at first of the step's own end; then "
        "q̇ ← q̇ + M⁻¹ (h F + W p), |p| ≤ h μ λ_N by Coulomb's law"
    )
    return _substeps(preset, formula, friction_late=True)


def _substeps(preset: Preset, formula: str, *, friction_late: bool) -> Law:
    count = preset["num_solver_iterations"]
    return Law(
        formula=f"{count} times, with h = Δt/{count} and F = f(t) e_1 − C q̇ − K q of the start of the step: {formula}",
        step=lambda lane, _: _step(lane, count, friction_late),
        bound=SINGLE_PRECISION_PERIOD,
        bound_reason="single precision: every substep rounds by 2^-24",
    )


def _step(lane: Lane, count: int, friction_late: bool) -> Step:
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


LAWS = {
    "joint:recommended": motor_substeps,
    "joint:default": motor_substeps,
    "contact:recommended": contact_substeps,
    "contact:default": contact_substeps,
}
"""By formulation and preset."""
