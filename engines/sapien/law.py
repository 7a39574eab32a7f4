"""The laws of SAPIEN: damped links, and the substeps of the temporal Gauss–Seidel solver."""

import math
from collections.abc import Mapping

import numpy as np

from multibody_xval.engines.interface.laws import Constant, Law, Step
from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.linear_law import LinearStep, linear_law
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray

SINGLE_PRECISION_PERIOD = 4e-5
"""Of U0: positions and velocities, of some U0 and U0 ω, are rounded by 2^-24 in each of 4,000 substeps. Roundings add
up as the root of their number: three standard deviations for motions of up to three U0."""

DRAWN_BACK_PERIOD = 6e-4
"""Of U0: a contact that sticks at the edge of its bound is drawn back to where it began to, and what draws it is as
uncertain as positions are, by 2^-24 of them over a substep: that alone may decide whether it slips in a step. It then
gains or lacks 7e-6 U0 a step of velocity, which carries it on for up to 400 / 2π steps, more at a resonance.
"""


def damped_links(preset: Preset) -> Law:
    """Give the law of an articulation, whose links are slowed down; its drives are exact."""

    def step(lane: Lane, of: Mapping[str, float]) -> Step:
        chain, h = lane.chain, lane.time_step
        kept = (1 - h * of["k"]) * chain.mass_matrix
        return linear_law(lane, LinearStep.of(chain, h, chain.mass_matrix, kept - h * chain.damping_matrix))

    return Law(
        formula="equation (5) with the force −k m v of the start of the step on every mass",
        constants={"k": Constant(preset["linear damping"], "1/s", "linear damping of links")},
        step=step,
        bound=SINGLE_PRECISION_PERIOD,
        bound_reason="single precision: every substep rounds by 2^-24",
    )


def temporal_gauss_seidel(preset: Preset) -> Law:
    """Give the law of the temporal Gauss–Seidel solver, with the forces of a step at its start."""
    substeps, corrections = preset["solver_position_iterations"], preset["solver_velocity_iterations"]
    # PhysX's own: 0.8, or less where there are many substeps.
    relaxation = min(0.8, 2 / math.sqrt(substeps))
    return Law(
        formula=(
            "q̇ ← q̇ + Δt M⁻¹ (f(t) e_1 − C q̇ − K q); then with e the slip since a contact began to stick, and "
            f"h = Δt/{substeps}, {substeps} times p ← clip(p − c m (w + c e / h), ± Δt μ λ_N), q ← q + h q̇, "
            f"and {corrections} times p alone; e ← 0 where p was cut off at last"
        ),
        constants={"c": Constant(relaxation, "", "relaxation: PhysX takes min(0.8, 2/√n)", visible_error=1.0)},
        step=lambda lane, of: _relaxed(lane, substeps, corrections, of["c"]),
        bound=DRAWN_BACK_PERIOD,
        bound_reason="single precision: at the edge of its bound it decides whether a contact slips in a step",
    )


def _relaxed(lane: Lane, substeps: int, corrections: int, relaxation: float) -> Step:
    """Bring impulses nearer to those that stop contacts and draw them back, while masses move."""
    chain, directions, h = lane.chain, lane.chain.contact_directions, lane.time_step / substeps
    masses = np.diag(chain.mass_matrix)
    reduced = 1 / (1 / chain.outer_mass + 1 / chain.inner_mass)
    slipped = np.zeros(chain.cells)

    def take(
        position: FloatArray, velocity: FloatArray, load: FloatArray, bound: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        force = -chain.damping_matrix @ velocity - chain.stiffness_matrix @ position
        force[0] += load[0]
        velocity, end, largest = velocity + lane.time_step * force / masses, position, lane.time_step * bound
        impulse = np.zeros(chain.cells)
        for sweep in range(substeps + corrections):
            back = slipped + directions.T @ (end - position)
            wanted = impulse - relaxation * reduced * (directions.T @ velocity + relaxation * back / h)
            given = np.clip(wanted, -largest, largest)
            velocity, impulse = velocity + directions @ (given - impulse) / masses, given
            if sweep < substeps:
                end = end + h * velocity
        slipped[:] = np.where(given == wanted, slipped + directions.T @ (end - position), 0.0)
        return end, velocity

    return take


LAWS = {
    "joint:default": damped_links,
    "contact:recommended": temporal_gauss_seidel,
    "contact:default": temporal_gauss_seidel,
}
"""By formulation and preset."""
