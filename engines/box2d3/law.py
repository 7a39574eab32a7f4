"""The law of Box2D 3's contacts: substeps under the forces of the step's start, with friction solved in each."""

from multibody_xval.engines.interface.laws import Law
from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.substep_law import substep_law

SINGLE_PRECISION_PERIOD = 3e-5
"""Of U0, at one substep: positions and velocities, of some U0 and U0 ω, are rounded by 2^-24 in each of 400 steps a
period, and more often by substeps. Roundings add up as the root of their number: three standard deviations for motions
of up to eight U0."""


def contacts(preset: Preset) -> Law:
    """Give the law of contacts, which are in equilibrium across: the friction of each substep has its bound at once."""
    count = preset["sub_step_count"]
    return Law(
        formula=f"{count} times, with h = Δt/{count} and F = f(t) e_1 − C q̇ − K q of the start of the step: "
        "q̇ ← q̇ + M⁻¹ (h F + W p), |p| ≤ h μ λ_N by Coulomb's law; q ← q + h q̇",
        step=lambda lane, _: substep_law(lane, count),
        bound=SINGLE_PRECISION_PERIOD * count**0.5,
        bound_reason="single precision: every substep rounds by 2^-24",
    )


LAWS = {"contact:default": contacts}
"""By formulation and preset."""
