"""The laws of Box2D 3's substeps: with springs and motors as joints, or under the forces of the step's start."""

from multibody_xval.engines.interface.laws import Law, Step
from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.linear_law import LinearStep, linear_law
from multibody_xval.engines.shared.substep_law import substep_law
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray

UNCONVERGED_PERIOD = 0.02
"""Of U0: joints are solved by two sweeps a substep, where the law solves them together. Measured are 0.012 at 400 steps
a period and a tenth of it at 4,000; a step of equation (5) is off by 0.28."""

SINGLE_PRECISION_PERIOD = 3e-5
"""Of U0, at one substep: positions and velocities, of some U0 and U0 ω, are rounded by 2^-24 in each of 400 steps a
period, and more often by substeps. Roundings add up as the root of their number: three standard deviations for motions
of up to eight U0."""


def joints(preset: Preset) -> Law:
    """Give the law of prismatic joints with springs and motors."""
    count = preset["sub_step_count"]
    return Law(
        formula=f"{count} times, with h = Δt/{count}: "
        "(M + h C + h² K) q̇⁺ = M q̇ − h K q + h f(t) e_1 + W p; Coulomb's law",
        step=lambda lane, _: _implicit_substeps(lane, count),
        bound=UNCONVERGED_PERIOD,
        bound_reason="two sweeps over joints in each substep",
    )


def _implicit_substeps(lane: Lane, count: int) -> Step:
    substep = linear_law(lane, LinearStep.implicit(lane.chain, lane.time_step / count))

    def take(
        position: FloatArray, velocity: FloatArray, load: FloatArray, bound: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        for _ in range(count):
            position, velocity = substep(position, velocity, load, bound)
        return position, velocity

    return take


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


LAWS = {
    "joint:recommended": joints,
    "joint:default": joints,
    "contact:recommended": contacts,
    "contact:default": contacts,
}
"""By formulation and preset."""
