"""The laws of Drake: actuators of bounded effort, and smooth friction of contacts that stay at their depth."""

from collections.abc import Mapping
from functools import partial

import numpy as np

from multibody_xval.engines.interface.law import Constant, Law, Step
from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.linear_law import LinearStep, linear_law, smooth_friction, soft_coulomb
from reference_lcp.chain.simulation import Lane

STEP = "(M + h C) q̇⁺ = M q̇ − h K q + h f(t) e_1 + W p"
"""What all formulas begin with: dashpots of joints act with the velocity at the end of the step."""

NEAR_RIGID = 0.1
"""β of Drake's near-rigid limit, which Python cannot set."""

SOFTNESS = 1e-3
"""σ of SAP's friction, which Python cannot set: no law is stiffer than R_t = σ √2/(3 m_i) [1/kg]. Drake takes the root
of the mean square of the three directions of the masses' inverses for one of them."""

SOLVER_PERIOD = 1e-5
"""Of U0: Drake's solver stops where a part of 1e-6 of the momentum is left, 4e-6 of U0 ω in the root of the squares of
fourteen masses. A law of straight pieces is solved exactly but for steps in which a contact changes to another one; a
period has a few."""

SMOOTH_PERIOD = 5e-5
"""Of U0: as above, but a smooth law leaves some of it in every step; a dozen steps add up before they decay."""

SOLVER_REASON = "Drake's solver stops where its residual is a part of 1e-6 of the momentum"


def actuator(preset: Preset) -> Law:
    """Give the law of an actuator with a gain in SI units."""
    return Law(
        formula=f"{STEP}; λ = −clip(d w⁺, ±μ λ_N)",
        constants={"d": Constant(preset["PdControllerGains.d"], "N s/m", "PdControllerGains.d")},
        step=lambda lane, of: linear_law(lane, _step(lane), soft_coulomb(1 / (of["d"] * lane.time_step))),
        bound=SOLVER_PERIOD,
        bound_reason=SOLVER_REASON,
    )


def near_rigid_actuator(preset: Preset) -> Law:
    """Give the law of an actuator whose gain is beyond the largest that Drake takes."""

    def step(lane: Lane, _: Mapping[str, float]) -> Step:
        chain = lane.chain
        wanted = (1 / chain.outer_mass + 1 / chain.inner_mass) / preset["d"]
        compliance = np.maximum(wanted, NEAR_RIGID**2 / (4 * np.pi**2 * chain.inner_mass))
        return linear_law(lane, _step(lane), soft_coulomb(compliance))

    return Law(
        formula=(
            f"{STEP}; λ = −clip(d w⁺, ±μ λ_N), d = min({preset['d']:g} / (A h), 4 π² m_i / (β² h)), β = {NEAR_RIGID}"
        ),
        step=step,
        bound=SOLVER_PERIOD,
        bound_reason=SOLVER_REASON,
    )


def lagged_contact(preset: Preset, visible_error: float = 0.01) -> Law:
    """Give the law of contacts whose normal force is that of the start of the step."""
    in_si = "v_stiction" in preset.options
    name, unit, symbol = ("v_stiction", "m/s", "v_s") if in_si else ("stiction", "", "v_s s ω_r")

    def step(lane: Lane, of: Mapping[str, float]) -> Step:
        chain = lane.chain
        scale = 1.0 if in_si else lane.drive.displacement_scale(chain) * chain.resonator_frequency
        least = lane.time_step * chain.friction_bound * SOFTNESS * np.sqrt(2) / (3 * chain.inner_mass)
        return linear_law(lane, _step(lane), smooth_friction(np.maximum(of["v_s"] * scale, least)))

    return Law(
        formula=f"{STEP}; λ = −μ λ_N w⁺ / √(w⁺² + z²), z = max({symbol}, σ √2/(3 m_i) h μ λ_N), σ = {SOFTNESS:g}",
        constants={"v_s": Constant(preset[name], unit, name, visible_error)},
        step=step,
        bound=SMOOTH_PERIOD,
        bound_reason=SOLVER_REASON,
    )


def _step(lane: Lane) -> LinearStep:
    chain, h = lane.chain, lane.time_step
    return LinearStep.of(chain, h, chain.mass_matrix + h * chain.damping_matrix, chain.mass_matrix)


LAWS = {
    "joint:tuned": near_rigid_actuator,
    "joint:default": actuator,
    "contact:tuned": partial(lagged_contact, visible_error=0.15),
    "contact:recommended": partial(lagged_contact, visible_error=0.15),
    "contact:default": lagged_contact,
}
"""By formulation and preset."""
