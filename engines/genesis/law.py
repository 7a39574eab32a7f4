"""The law of Genesis's friction of joints: MuJoCo's, with explicit dashpots and half of its time constant."""

from collections.abc import Mapping

from multibody_xval.engines.interface.laws import Constant, Law, Step
from multibody_xval.engines.interface.presets import OfStep, Preset
from multibody_xval.engines.mujoco.softness import damping_rate, relative_softness
from multibody_xval.engines.shared.linear_law import LinearStep, linear_law, soft_coulomb
from reference_lcp.chain.simulation import Lane

NEWTON_PERIOD = 1e-5
"""Of U0: Genesis's Newton stops where a step of it would gain less than 1e-8, as MuJoCo's does, which makes 4e-6 U0 of
the gentlest motion that presets are held to (see MuJoCo's); it does so in a step or two of a period."""


def joint_friction(preset: Preset) -> Law:
    """Give the law of a joint's frictionloss; a time constant of two steps is the least there is."""
    given = preset["constraint_timeconst"]
    least, largest = preset["solimplimit"]
    constants = {
        "d_0": Constant(least, "", "solimplimit: where nothing is violated"),
        "d_max": Constant(largest, "", "solimplimit; the time constant is scaled by it"),
    }
    if not isinstance(given, OfStep):
        constants["τ"] = Constant(given, "s", "constraint_timeconst")
    return Law(
        formula=(
            "equation (5) with friction λ = clip(−(a_0 + b w) / (A + R), ±μ λ_N): a_0 the slip acceleration without "
            "it and w the slip velocity at the start of the step, A = (Wᵀ M⁻¹ W)_ii, b = 2 / (d_max max(τ, 2h)), "
            "R = A (1 − d_0) / d_0"
        ),
        constants=constants,
        step=_step,
        bound=NEWTON_PERIOD,
        bound_reason="Genesis's Newton solver stops at a tolerance of 1e-8, now and then before all is solved",
    )


def _step(lane: Lane, of: Mapping[str, float]) -> Step:
    """Take the step of equation (5), in which friction sees the slip to be stopped at the rate b."""
    chain, h, mass = lane.chain, lane.time_step, lane.chain.mass_matrix
    rate = damping_rate(of.get("τ", 0.0), of["d_max"], h)
    step = LinearStep.of(chain, h, mass, mass - h * chain.damping_matrix, slip_weight=h * rate - 1)
    return linear_law(lane, step, soft_coulomb(relative_softness(of["d_0"]) * step.coupling.diagonal()))


LAWS = {"joint:recommended": joint_friction, "joint:default": joint_friction}
"""By formulation and preset."""
