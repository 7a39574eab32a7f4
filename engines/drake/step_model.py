"""The laws of Drake: actuators of bounded effort, and spheres that friction may lift off the depth of their rest."""

import functools
import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from multibody_xval.engines.interface.law import Constant, Law
from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.kernel_lane import KernelLane
from multibody_xval.engines.shared.units import power_of_two
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.schemes.linear_implicit import LinearImplicitLane, LinearStep, ScalarFriction
from reference_lcp.validation import FloatArray


def contact_scale(lane: Lane) -> float:
    """Give the power of two near the displacement scale [m]: depths are then exact."""
    return power_of_two(lane.drive.displacement_scale(lane.chain))


def stiction_speed(lane: Lane, stiction: float) -> float:
    """Give the velocity at which friction is near its bound [m/s], from one over s ω_r."""
    return stiction * lane.drive.displacement_scale(lane.chain) * lane.chain.resonator_frequency


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

_law = functools.partial(Law, period_bound=SOLVER_PERIOD, bound_reason=SOLVER_REASON)


def actuator(preset: Preset) -> Law:
    """Give the law of an actuator with a gain in SI units."""

    def model(lane: Lane, constants: Mapping[str, float]) -> LinearImplicitLane:
        compliance = 1 / (constants["d"] * lane.time_step)
        return LinearImplicitLane(lane, _step(lane), ScalarFriction.coulomb(lane.chain.cells, compliance))

    return _law(
        formula=f"{STEP}; λ = −clip(d w⁺, ±μ λ_N)",
        constants={"d": Constant(preset["PdControllerGains.d"], "N s/m", "PdControllerGains.d", ideal=math.inf)},
        model=model,
    )


def near_rigid_actuator(preset: Preset) -> Law:
    """Give the law of an actuator whose gain is beyond the largest that Drake takes."""

    def model(lane: Lane, constants: Mapping[str, float]) -> LinearImplicitLane:
        chain = lane.chain
        wanted = (1 / chain.outer_mass + 1 / chain.inner_mass) / preset["d"]
        compliance = np.maximum(wanted, constants["β"] ** 2 / (4 * np.pi**2 * chain.inner_mass))
        return LinearImplicitLane(lane, _step(lane), ScalarFriction.coulomb(chain.cells, compliance))

    return _law(
        formula=f"{STEP}; λ = −clip(d w⁺, ±μ λ_N), d = min({preset['d']:g} / (A h), 4 π² m_i / (β² h))",
        constants={"β": Constant(0.1, "", "Drake's near-rigid limit, which Python cannot set", visible_error=0.5)},
        model=model,
    )


def lagged_contact(preset: Preset) -> Law:
    """Give the law of contacts whose normal force is that of the start of the step."""
    in_si = "v_stiction" in preset.options
    constant = _stiction_in_si(preset["v_stiction"]) if in_si else _stiction(preset)
    formula = "v_s" if in_si else "v_s s ω_r"

    def model(lane: Lane, constants: Mapping[str, float]) -> LinearImplicitLane:
        speed = constants["v_s"] if in_si else stiction_speed(lane, constants["v_s"])
        speeds = _stiction_speeds(lane, speed, constants["σ"])
        return LinearImplicitLane(lane, _step(lane), ScalarFriction.smooth(lane.chain.cells, speeds))

    return _law(
        formula=f"{STEP}; λ = −μ λ_N w⁺ / √(w⁺² + z²), z = max({formula}, R_t h μ λ_N), {SOFTNESS}",
        constants={"v_s": constant, "σ": _least_softness(constant.value if in_si else math.inf)},
        model=model,
        period_bound=SMOOTH_PERIOD,
    )


DRAKE_S_STICTION = 1e-3
"""Drake's own v_stiction [m/s], of which a hundredth is seen: of a smaller one, as much more of it."""


def _stiction_in_si(speed: float) -> Constant:
    return Constant(speed, "m/s", "v_stiction", ideal=0.0, visible_error=0.01 * max(1.0, DRAKE_S_STICTION / speed))


def _least_softness(speed: float) -> Constant:
    """Give SAP's softness beside a stiction velocity [m/s]: far below Drake's own, the softness is seen."""
    seen = speed < DRAKE_S_STICTION / 10
    return replace(LEAST_SOFTNESS, too_small_to_see=False, visible_error=0.5) if seen else LEAST_SOFTNESS


def sap_contact(preset: Preset) -> Law:
    """Give the law of the convex approximation: friction and normal impulse of one cone, both soft."""
    return _law(
        formula=(
            f"{STEP}; across the plane y⁺ = y − h λ_N/m_i + γ/m_i, z⁺ = z + h y⁺; with k = λ_N/δ, R_n = 1/(h² k), "
            "R_t = σ √2/(3 m_i): p and γ minimise the regularised work over |p| <= μ γ, γ aims at y⁺ = −z/h"
        ),
        constants={
            "δ": Constant(preset["depth"], "", "depth, over s"),
            "σ": Constant(1e-3, "", "softness of SAP's friction, which Python cannot set", visible_error=0.5),
        },
        model=GlidingLane,
    )


def similar_contact(preset: Preset) -> Law:
    """Give the law of the smooth approximation whose normal force friction changes."""
    return _law(
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
        model=GlidingLane,
        period_bound=SMOOTH_PERIOD,
    )


def _softness(lane: Lane, share: float) -> FloatArray:
    """Give R_t [1/kg] of SAP's contacts, shape (n,).

    Drake takes the root of the mean square of the three directions of the masses' inverses for one of them.
    """
    return share * np.sqrt(2) / (3 * lane.chain.inner_mass)


def _stiction_speeds(lane: Lane, speed: float, share: float) -> FloatArray:
    """Give the velocities within which friction is off its bound [m/s], shape (n,): no law is stiffer than SAP's."""
    least: FloatArray = lane.time_step * lane.chain.friction_bound * _softness(lane, share)
    return np.maximum(speed, least)


def _stiction(preset: Preset) -> Constant:
    return Constant(preset["stiction"], "", "stiction, over s ω_r", visible_error=0.15)


def _step(lane: Lane) -> LinearStep:
    chain, h = lane.chain, lane.time_step
    return LinearStep.of(chain, h, chain.mass_matrix + h * chain.damping_matrix, chain.mass_matrix, (1.0, 0.0))


class GlidingLane(KernelLane):
    """One chain of spheres, whose internal state is the place of every sphere, then its place a step later.

    At rest they are δ deep. Contacts of kSap are soft; with a stiction velocity v_s they are those of kSimilar.
    """

    columns = 6

    def __init__(self, lane: Lane, constants: Mapping[str, float]):
        super().__init__(lane)
        chain, smoothing = lane.chain, np.zeros(lane.chain.cells)
        if "v_s" in constants:
            smoothing = _stiction_speeds(lane, stiction_speed(lane, constants["v_s"]), constants["σ"])
        self._step, self._depth = _step(lane), constants["δ"] * contact_scale(lane)
        self._contact = (
            np.where(chain.friction_bound > 0, chain.friction_coefficient, 0.0),
            chain.normal_force.copy(),
            chain.inner_mass.copy(),
            _softness(lane, constants["σ"]),
            smoothing,
        )

    def _integrate(self, state: State, start: int, steps: int, record: FloatArray) -> State:
        from multibody_xval.engines.drake.step_kernel import advance  # numba is imported once something moves

        step, motion, across = self._step, np.vstack([state.positions[0], state.velocities[0]]), self._across(state)
        matrices = step.state, np.ascontiguousarray(step.load[:, 0]), step.response, step.coupling
        loads, numbers = self.lane.loads(start, steps), (step.length, self._depth)
        advance(motion, across, loads, matrices, numbers, self._contact, record)
        place, velocity = across
        return State(motion[:1], motion[1:], np.concatenate([place, place + step.length * velocity])[None])

    def _across(self, state: State) -> FloatArray:
        """Give places and velocities of the spheres, at rest where the state has none."""
        cells = self.lane.chain.cells
        if state.internal_state is None:
            return np.vstack([np.where(self._contact[0] > 0, -self._depth, 0.0), np.zeros(cells)])
        place, later = np.split(state.internal_state[0], 2)
        return np.vstack([place, (later - place) / self._step.length])
