"""The law of Box2D 3's contacts: substeps under the forces of the step's start, with friction solved in each."""

from multibody_xval.engines.interface.laws import Law
from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.substep_law import substep_law

SINGLE_PRECISION_PERIOD = 1.7e-5
"""Of U0, for each substep: positions of up to eight U0 are rounded to 2^-20 U0, a standard deviation of 2.8e-7. Forces
are held over the substeps of a step, so that these round alike: their roundings add up in proportion to their number,
and those of 400 steps as its root. Three standard deviations."""


def contacts(preset: Preset) -> Law:
    """Give the law of contacts, which are in equilibrium across: the friction of each substep has its bound at once."""
    count = preset["sub_step_count"]
    return Law(
        formula=f"{count} times, with h = Δt/{count} and F = f(t) e_1 − C q̇ − K q of the start of the step: "
        "q̇ ← q̇ + M⁻¹ (h F + W p), |p| ≤ h μ λ_N by Coulomb's law; q ← q + h q̇",
        step=lambda lane, _: substep_law(lane, count),
        bound=SINGLE_PRECISION_PERIOD * count,
        bound_reason="single precision: the substeps of a step round alike, by 2^-24",
    )


LAWS = {"contact:default": contacts, "contact:recommended": contacts}
"""By formulation and preset."""
