"""The law of Rapier's substeps: forces of the start of a step, and friction solved anew in every part of it."""

from multibody_xval.engines.interface.laws import Law
from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.substep_law import substep_law

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
        step=lambda lane, _: substep_law(lane, count, friction_late=friction_late),
        bound=SINGLE_PRECISION_PERIOD,
        bound_reason="single precision: every substep rounds by 2^-24",
    )


LAWS = {
    "joint:recommended": motor_substeps,
    "joint:default": motor_substeps,
    "contact:recommended": contact_substeps,
    "contact:default": contact_substeps,
}
"""By formulation and preset."""
