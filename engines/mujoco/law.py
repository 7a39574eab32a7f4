"""The law of MuJoCo's friction of joints: a constraint with a time constant, softened by a part of the inverse mass."""

from collections.abc import Mapping

from multibody_xval.engines.interface.laws import Constant, Law, Step
from multibody_xval.engines.interface.presets import OfStep, Preset
from multibody_xval.engines.mujoco.softness import (
    LARGEST_IMPEDANCE,
    LEAST_IMPEDANCE,
    damping_rate,
    relative_softness,
)
from multibody_xval.engines.shared.linear_law import LinearStep, linear_law, soft_coulomb
from reference_lcp.chain.simulation import Lane

NEWTON_PERIOD = 3e-5
"""Of U0: MuJoCo's Newton stops where a step of it would lower its cost, over the inertia, by less than 1e-8 (m/s²)²
a degree of freedom. Up to √(2 · 14 · 1e-8) = 5e-4 m/s² are then left in that time step, which make 4e-6 U0 of a motion
with U0 ω² = 2 m/s², the gentlest that presets are held to; a period has a few such steps."""

NEWTON_REASON = "MuJoCo's Newton solver stops at a tolerance of 1e-8, now and then before all is solved"


def joint_friction(preset: Preset) -> Law:
    """Give the law of a joint's frictionloss; a time constant of two steps is the least there is."""
    given = preset["solref_friction"]
    least, largest = LEAST_IMPEDANCE, LARGEST_IMPEDANCE
    if "solimp_friction" in preset.options:
        least, largest = preset["solimp_friction"]
    constants = {
        "d_0": Constant(least, "", "solimp_friction: where nothing is violated"),
        "d_max": Constant(largest, "", "solimp_friction; solref is scaled by it"),
    }
    if not isinstance(given, OfStep):
        constants["τ"] = Constant(given[0], "s", "solref_friction, time constant")
    return Law(
        formula=(
            "forces at the start of the step: with a_0 = Wᵀ M⁻¹ (f(t) e_1 − C q̇ − K q), A = (Wᵀ M⁻¹ W)_ii, "
            "b = 2 / (d_max max(τ, 2h)): λ = clip(−(a_0 + b w) / (A + R), ±μ λ_N), R = A (1 − d_0) / d_0; "
            "dashpots of joints (c_i) then implicit, (M + h C_i) q̇⁺ = (M + h C_i − h C) q̇ − h K q + h f(t) e_1 + h W λ"
        ),
        constants=constants,
        step=_step,
        bound=NEWTON_PERIOD,
        bound_reason=NEWTON_REASON,
    )


def _step(lane: Lane, of: Mapping[str, float]) -> Step:
    """Friction knows no dashpot of a joint at the end of the step, the masses do."""
    chain, h = lane.chain, lane.time_step
    mass, damping, directions = chain.mass_matrix, chain.damping_matrix, chain.contact_directions
    matrix = mass + h * (directions * chain.inner_damping) @ directions.T
    rate = damping_rate(of.get("τ", 0.0), of["d_max"], h)
    seen = LinearStep.of(chain, h, mass, mass - h * damping, slip_weight=h * rate - 1)
    step = LinearStep.of(chain, h, matrix, matrix - h * damping).with_friction_of(seen)
    return linear_law(lane, step, soft_coulomb(relative_softness(of["d_0"]) * step.coupling.diagonal()))


LAWS = {"joint:recommended": joint_friction, "joint:default": joint_friction}
"""By formulation and preset."""
