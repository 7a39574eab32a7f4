"""The laws of MuJoCo's default friction: a constraint with a time constant, softened by a part of the inverse mass."""

from collections.abc import Mapping

import numpy as np

from engines.interface.law import Constant, Law
from engines.interface.presets import NormalForce, Preset
from engines.mujoco.model import DEPTH, LEAST_COEFFICIENT
from engines.mujoco.pyramid import PyramidLane
from engines.shared.units import power_of_two
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.stepping.linear_implicit import LinearImplicitLane, LinearStep, ScalarFriction
from reference_lcp.stepping.sequential import LaneModel
from reference_lcp.validation import FloatArray

LEAST_IMPEDANCE, LARGEST_IMPEDANCE, WIDTH = 0.9, 0.95, 0.001
"""d_0, d_max and width [m] of MuJoCo's `solimp`, for contacts and for frictionloss alike; no preset sets them."""

NEWTON_PERIOD = 3e-5
"""Of U0: MuJoCo's Newton stops where a step of it would lower its cost, over the inertia, by less than 1e-8 (m/s²)²
a degree of freedom. Up to √(2 · 14 · 1e-8) = 5e-4 m/s² are then left in that time step, which make 4e-6 U0 of a motion
with U0 ω² = 2 m/s², the gentlest that presets are held to; a period has a few such steps."""

NEWTON_REASON = "MuJoCo's Newton solver stops at a tolerance of 1e-8, now and then before all is solved"

HELD_FORMULA = (
    "as the joint's, with s = a_0 + A λ + b w, b = 2 / (τ d_max), R = 2 μ² (1 + μ²) (1 − d) / d (1/m_o + 2/m_i) / 3: "
    "λ = −2 μ² s / R while both edges press, μ |s| <= R λ_N / 4, and λ = −sgn(s) μ (R λ_N / 4 + μ |s|) / R beyond, "
    "without a bound; d from d_0 to d_max by the depth over the width δ; the normal force is λ_N/2 + max(λ_N/2, |λ|/μ)"
)
"""Of a sphere held at a fixed depth: each of the two edges along the slide lets go alone. In a row that is turned all
four edges are solved together, as those of a free sphere, with the load λ_N / 4 each instead of a depth."""

FREE_FORMULA = (
    "under a preload, with y the acceleration of the sphere on its plate in three directions and E the edges n ± μ t: "
    "0 <= f ⟂ E y + b E ẋ − k d z + R f >= 0 at the depth z > 0, f = 0 above the plate, y = y_0 + A Eᵀ f, "
    "b = 2 / (d_max max(τ, 2h)), k = 1 / (d_max max(τ, 2h))², R = 2 μ² (1 + μ²) (1 − d) / d (1/m_o + 3/m_i) / 3"
)
"""Of a sphere that is free across the row."""


def joint_friction(preset: Preset) -> Law:
    """Give the law of a joint's frictionloss."""
    return Law(
        formula=(
            "forces at the start of the step: with a_0 = Wᵀ M⁻¹ (f(t) e_1 − C q̇ − K q), A = (Wᵀ M⁻¹ W)_ii, "
            "b = 2 / (d_max max(τ, 2h)): λ = clip(−(a_0 + b w) / (A + R), ±μ λ_N), R = A (1 − d_0) / d_0; "
            "dashpots of joints (c_i) then implicit, (M + h C_i) q̇⁺ = (M + h C_i − h C) q̇ − h K q + h f(t) e_1 + h W λ"
        ),
        constants={
            "τ": Constant(preset["solref_friction"][0], "s", "solref_friction, time constant"),
            "d_0": Constant(LEAST_IMPEDANCE, "", "solimp_friction, MuJoCo's own: where nothing is violated"),
            "d_max": Constant(LARGEST_IMPEDANCE, "", "solimp_friction, MuJoCo's own; solref is scaled by it"),
        },
        model=_joint_friction,
        period_bound=NEWTON_PERIOD,
        bound_reason=NEWTON_REASON,
        modulated=True,
    )


def pyramidal_contact(preset: Preset) -> Law:
    """Give the law of a sphere with a pyramid of four edges: held at a fixed depth or, with a preload, free."""
    lifting = preset.represents(NormalForce.LIFTING)
    return Law(
        formula=f"{HELD_FORMULA}; {FREE_FORMULA}" if lifting else HELD_FORMULA,
        constants={
            "τ": Constant(preset["normal time constant"], "s", "normal time constant; of a free sphere, solref"),
            "d_0": Constant(LEAST_IMPEDANCE, "", "solimp, MuJoCo's own: of a contact that touches"),
            "d_max": Constant(LARGEST_IMPEDANCE, "", "solimp, MuJoCo's own: of one deeper than the width"),
            "δ": Constant(WIDTH, "m", "solimp, MuJoCo's own"),
        },
        model=_pyramidal_contact,
        period_bound=NEWTON_PERIOD,
        bound_reason=NEWTON_REASON,
        modulated=lifting,
        lifting=lifting,
        inclines=preset.inclines,
    )


def _joint_friction(lane: Lane, constants: Mapping[str, float]) -> LinearImplicitLane:
    rate = 2 / (constants["d_max"] * max(constants["τ"], 2 * lane.time_step))
    step = _step(lane, rate)
    softness = (1 - constants["d_0"]) / constants["d_0"]
    return LinearImplicitLane(lane, step, ScalarFriction.coulomb(lane.chain.cells, softness * step.coupling.diagonal()))


def _pyramidal_contact(lane: Lane, constants: Mapping[str, float]) -> LaneModel:
    time_constant = constants["τ"] if lane.preload is None else max(constants["τ"], 2 * lane.time_step)
    rate = 2 / (constants["d_max"] * time_constant)
    step = _step(lane, rate)
    if lane.preload is not None or lane.direction:
        return PyramidLane(lane, step, rate, constants)
    # MuJoCo takes the inverse mass of a body as a mean over three axes: an outer mass slides along one of them.
    inverse_mass = (1 / lane.chain.outer_mass + 2 / lane.chain.inner_mass) / 3
    return PyramidalContactLane(lane, step, inverse_mass, constants)


class PyramidalContactLane(LinearImplicitLane):
    """A step with friction of two edges, of which one lets go at half of the bound.

    Parameters
    ----------
    lane, step
        The chain, and the step in which friction is solved.
    inverse_mass
        What a contact's softness is a part of [1/kg], shape (n,).
    constants
        Those of `solimp`.
    """

    def __init__(self, lane: Lane, step: LinearStep, inverse_mass: FloatArray, constants: Mapping[str, float]):
        chain = lane.chain
        impedance = _impedance(DEPTH * power_of_two(lane.drive.displacement_scale(chain)), constants)
        self._coefficient = np.maximum(chain.friction_coefficient, LEAST_COEFFICIENT)
        compliance = (1 + self._coefficient**2) * (1 - impedance) / impedance * inverse_mass
        friction = ScalarFriction.coulomb(chain.cells, compliance, 1 / (2 * compliance), bound_share=0.5)
        super().__init__(lane, step, friction)

    def normal_force(self, friction: FloatArray, preload: FloatArray) -> FloatArray:
        """Give the sum over the edges: two across the slide keep their half, those along it carry the friction."""
        return preload / 2 + np.maximum(preload / 2, np.abs(friction) / self._coefficient)


def _step(lane: Lane, rate: float) -> LinearStep:
    """Give MuJoCo's step: friction knows no dashpot of a joint at the end of the step, the masses do."""
    chain, h = lane.chain, lane.time_step
    mass, damping = chain.mass_matrix, chain.damping_matrix
    matrix = mass + h * _inner_dashpots(chain)
    seen = LinearStep.of(chain, h, mass, mass - h * damping, (1.0, 0.0), slip_weight=h * rate - 1)
    return LinearStep.of(chain, h, matrix, matrix - h * damping, (1.0, 0.0)).with_friction_of(seen)


def _inner_dashpots(chain: Chain) -> FloatArray:
    directions = chain.contact_directions
    dashpots: FloatArray = directions @ np.diag(chain.inner_damping) @ directions.T
    return dashpots


def _impedance(depth: float, constants: Mapping[str, float]) -> float:
    """Give d at a depth [m]: `solimp` with its midpoint 0.5 and its power 2, MuJoCo's own."""
    from engines.mujoco.pyramid_kernel import impedance  # numba is imported once something moves

    return float(impedance(depth, constants["d_0"], constants["d_max"], constants["δ"]))
