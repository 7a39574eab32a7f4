"""The laws of Drake: dashpots at the end of a step, springs at its start, and friction regularised in three ways."""

import functools
from collections.abc import Mapping

import numpy as np

from engines.drake.pressed_sphere import GlidingLane
from engines.drake.sizes import sphere_depth, stiction_speed
from engines.interface.law import Constant, Law
from engines.interface.presets import Preset
from reference_lcp.chain.simulation import Lane
from reference_lcp.stepping.linear_implicit import LinearImplicitLane, LinearStep, ScalarFriction
from reference_lcp.validation import FloatArray

STEP = "(M + h C) q̇⁺ = M q̇ − h K q + h f(t) e_1 + W p"
"""What all formulas begin with."""

SOFTNESS = "R_t = σ √2/(3 m_i)"
"""Of SAP's contacts along the plane."""

LEAST_SOFTNESS = Constant(
    1e-3, "", "softness of SAP's friction, which Python cannot set: seen where forces are large", too_small_to_see=True
)
"""In laws that are smooth within the stiction velocity."""

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
        model=_actuator,
        period_bound=SOLVER_PERIOD,
        bound_reason=SOLVER_REASON,
    )


def near_rigid_actuator(preset: Preset) -> Law:
    """Give the law of an actuator whose gain is beyond the largest that Drake takes."""
    return Law(
        formula=f"{STEP}; λ = −clip(d w⁺, ±μ λ_N), d = min({preset['d']:g} / (A h), 4 π² m_i / (β² h))",
        constants={"β": Constant(0.1, "", "Drake's near-rigid limit, which Python cannot set", visible_error=0.5)},
        model=functools.partial(_near_rigid_actuator, gain=preset["d"]),
        period_bound=SOLVER_PERIOD,
        bound_reason=SOLVER_REASON,
    )


def lagged_contact(preset: Preset) -> Law:
    """Give the law of contacts whose normal force is that of the start of the step."""
    if "v_stiction" in preset.options:
        constant, formula = Constant(preset["v_stiction"], "m/s", "v_stiction"), "v_s"
    else:
        constant, formula = _stiction(preset), "v_s s ω_r"
    return Law(
        formula=f"{STEP}; λ = −μ λ_N w⁺ / √(w⁺² + z²), z = max({formula}, R_t h μ λ_N), {SOFTNESS}",
        constants={"v_s": constant, "σ": LEAST_SOFTNESS},
        model=_lagged_si if "v_stiction" in preset.options else _lagged_of_drive,
        period_bound=SMOOTH_PERIOD,
        bound_reason=SOLVER_REASON,
    )


def sap_contact(preset: Preset) -> Law:
    """Give the law of the convex approximation: friction and normal impulse of one cone, both soft."""
    return Law(
        formula=(
            f"{STEP}; across the plane y⁺ = y − h λ_N/m_i + γ/m_i, z⁺ = z + h y⁺; with k = λ_N/δ, R_n = 1/(h² k), "
            "R_t = σ √2/(3 m_i): p and γ minimise the regularised work over |p| <= μ γ, γ aims at y⁺ = −z/h"
        ),
        constants={
            "δ": Constant(preset["depth"], "", "depth, over s"),
            "σ": Constant(1e-3, "", "softness of SAP's friction, which Python cannot set", visible_error=0.5),
        },
        model=_sap,
        period_bound=SOLVER_PERIOD,
        bound_reason=SOLVER_REASON,
    )


def similar_contact(preset: Preset) -> Law:
    """Give the law of the smooth approximation whose normal force friction changes."""
    return Law(
        formula=(
            f"{STEP}; across the plane y⁺ = y − h λ_N/m_i + γ/m_i, z⁺ = z + h y⁺; with k = λ_N/δ, z_s = max(v_s s ω_r, "
            f"R_t h μ λ_N), {SOFTNESS}: "
            "γ = h max(0, −k z − h k (y⁺ − μ (√(w⁺² + z_s²) − z_s))), p = −μ γ w⁺/√(w⁺² + z_s²)"
        ),
        constants={
            "δ": Constant(preset["depth"], "", "depth, over s"),
            "v_s": _stiction(preset),
            "σ": LEAST_SOFTNESS,
        },
        model=_similar,
        period_bound=SMOOTH_PERIOD,
        bound_reason=SOLVER_REASON,
    )


def _softness(lane: Lane, share: float) -> FloatArray:
    """Give R_t [1/kg] of SAP's contacts, shape (n,).

    Drake takes the root of the mean square of the three directions of the masses' inverses for one of them.
    """
    softness: FloatArray = share * np.sqrt(2) / (3 * lane.chain.inner_mass)
    return softness


def _stiction_speeds(lane: Lane, speed: float, share: float) -> FloatArray:
    """Give the velocities within which friction is off its bound [m/s], shape (n,): no law is stiffer than SAP's."""
    least: FloatArray = lane.time_step * lane.chain.friction_bound * _softness(lane, share)
    return np.maximum(speed, least)


def _stiction(preset: Preset) -> Constant:
    return Constant(preset["stiction"], "", "stiction, over s ω_r", visible_error=0.15)


def _step(lane: Lane) -> LinearStep:
    chain, h = lane.chain, lane.time_step
    return LinearStep.of(chain, h, chain.mass_matrix + h * chain.damping_matrix, chain.mass_matrix, (1.0, 0.0))


def _actuator(lane: Lane, constants: Mapping[str, float]) -> LinearImplicitLane:
    compliance = 1 / (constants["d"] * lane.time_step)
    return LinearImplicitLane(lane, _step(lane), ScalarFriction.coulomb(lane.chain.cells, compliance))


def _near_rigid_actuator(lane: Lane, constants: Mapping[str, float], gain: float) -> LinearImplicitLane:
    """Build a lane; the gain is in units of the reduced mass over the time step."""
    chain = lane.chain
    wanted = (1 / chain.outer_mass + 1 / chain.inner_mass) / gain
    compliance = np.maximum(wanted, constants["β"] ** 2 / (4 * np.pi**2 * chain.inner_mass))
    return LinearImplicitLane(lane, _step(lane), ScalarFriction.coulomb(lane.chain.cells, compliance))


def _lagged_si(lane: Lane, constants: Mapping[str, float]) -> LinearImplicitLane:
    speeds = _stiction_speeds(lane, constants["v_s"], constants["σ"])
    return LinearImplicitLane(lane, _step(lane), ScalarFriction.smooth(lane.chain.cells, speeds))


def _lagged_of_drive(lane: Lane, constants: Mapping[str, float]) -> LinearImplicitLane:
    speeds = _stiction_speeds(lane, stiction_speed(lane, constants["v_s"]), constants["σ"])
    return LinearImplicitLane(lane, _step(lane), ScalarFriction.smooth(lane.chain.cells, speeds))


def _sap(lane: Lane, constants: Mapping[str, float]) -> GlidingLane:
    softness = _softness(lane, constants["σ"])
    return GlidingLane(lane, _step(lane), sphere_depth(lane, constants["δ"]), softness=softness)


def _similar(lane: Lane, constants: Mapping[str, float]) -> GlidingLane:
    speeds = _stiction_speeds(lane, stiction_speed(lane, constants["v_s"]), constants["σ"])
    return GlidingLane(lane, _step(lane), sphere_depth(lane, constants["δ"]), smoothing=speeds)
