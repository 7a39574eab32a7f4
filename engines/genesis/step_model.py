"""The laws of Genesis's default friction: MuJoCo's, with explicit dashpots and half of its time constant."""

import math
from collections.abc import Mapping

from multibody_xval.engines.interface.law import Constant, Law, NotModelled
from multibody_xval.engines.interface.presets import OfStep, Preset
from multibody_xval.engines.mujoco.step_model import (
    FREE_FORMULA,
    LARGEST_IMPEDANCE,
    LEAST_IMPEDANCE,
    RUBS_AND_PRESSES,
    VANISHING_STEP,
    WIDTH,
    PyramidalContactLane,
    PyramidLane,
    damping_rate,
)
from reference_lcp.chain.simulation import Lane
from reference_lcp.schemes.linear_implicit import LinearImplicitLane, LinearStep, ScalarFriction
from reference_lcp.schemes.sequential import LaneModel

NEWTON_PERIOD = 1e-5
"""Of U0: Genesis's Newton stops where a step of it would gain less than 1e-8, as MuJoCo's does, which makes 4e-6 U0 of
the gentlest motion that presets are held to (see MuJoCo's); it does so in a step or two of a period."""

NEWTON_REASON = "Genesis's Newton solver stops at a tolerance of 1e-8, now and then before all is solved"


HELD_FORMULA = (
    "as the joint's, with s = a_0 + A λ + b w, R = 2 μ² (1 + μ²) (1 − d) / d (1/m_o + 1/m_i) / 3: "
    "λ = −2 μ² s / R while both edges press, μ |s| <= R λ_N / 4, and λ = −sgn(s) μ (R λ_N / 4 + μ |s|) / R "
    "beyond, without a bound; d from d_0 to d_max by the depth over the width δ; the normal force is "
    "λ_N/2 + max(λ_N/2, |λ|/μ)"
)

OF_STEP = NotModelled("its law is that of a time constant, whatever the time step")


def joint_friction(preset: Preset) -> Law | NotModelled:
    """Give the law of a joint's frictionloss."""
    constant = preset.value("constraint_timeconst", VANISHING_STEP)
    fixed = constant > 2 * VANISHING_STEP
    least, largest = preset["solimplimit"]
    return Law(
        formula=(
            "equation (5) with friction λ = clip(−(a_0 + b w) / (A + R), ±μ λ_N): a_0 the slip acceleration without "
            "it and w the slip velocity at the start of the step, A = (Wᵀ M⁻¹ W)_ii, b = 2 / (d_max max(τ, 2h)), "
            "R = A (1 − d_0) / d_0"
        ),
        constants={
            **({"τ": Constant(constant, "s", "constraint_timeconst", ideal=0.0)} if fixed else {}),
            "d_0": Constant(least, "", "solimplimit: where nothing is violated", ideal=1.0),
            "d_max": Constant(largest, "", "solimplimit; the time constant is scaled by it", ideal=1.0),
        },
        model=_joint_friction,
        period_bound=NEWTON_PERIOD,
        bound_reason=NEWTON_REASON,
        modulated=True,
    )


def pyramidal_contact(preset: Preset) -> Law | NotModelled:
    """Give the law of a sphere: MuJoCo's of a free one; of one that is held, each of the two edges lets go alone."""
    if isinstance(preset["constraint_timeconst"], OfStep):
        return OF_STEP
    free = preset.is_free
    return Law(
        formula=FREE_FORMULA if free else HELD_FORMULA,
        constants={
            "τ": Constant(preset["constraint_timeconst"], "s", "constraint_timeconst, Genesis's own", ideal=math.inf),
            "d_0": Constant(LEAST_IMPEDANCE, "", "solimp, Genesis's own: of a contact that touches", ideal=0.0),
            "d_max": Constant(LARGEST_IMPEDANCE, "", "solimp, Genesis's own: of one deeper than the width", ideal=0.0),
            "δ": Constant(WIDTH, "m", "solimp, Genesis's own"),
        },
        model=lambda lane, of: _pyramidal_contact(preset.pressed(lane), of),
        without_friction=RUBS_AND_PRESSES,
        period_bound=NEWTON_PERIOD,
        bound_reason=NEWTON_REASON,
        modulated=free,
        lifting=free,
    )


def _joint_friction(lane: Lane, constants: Mapping[str, float]) -> LinearImplicitLane:
    step = _step(lane, constants)
    softness = (1 - constants["d_0"]) / constants["d_0"]
    return LinearImplicitLane(lane, step, ScalarFriction.coulomb(lane.chain.cells, softness * step.coupling.diagonal()))


def _pyramidal_contact(lane: Lane, constants: Mapping[str, float]) -> LaneModel:
    chain, step = lane.chain, _step(lane, constants)
    if lane.preload is not None:
        rate = damping_rate(constants["τ"], constants["d_max"], lane.time_step)
        return PyramidLane(lane, step, rate, constants)
    # Genesis takes the inverse mass of a body as a mean over three axes; it slides along one of them.
    inverse_mass = (1 / chain.outer_mass + 1 / chain.inner_mass) / 3
    return PyramidalContactLane(lane, step, inverse_mass, constants)


def _step(lane: Lane, constants: Mapping[str, float]) -> LinearStep:
    """Give the step of equation (5), in which friction sees the slip to be stopped at the rate b."""
    chain, h = lane.chain, lane.time_step
    rate = damping_rate(constants.get("τ", 0.0), constants["d_max"], h)
    mass = chain.mass_matrix
    return LinearStep.of(chain, h, mass, mass - h * chain.damping_matrix, (1.0, 0.0), slip_weight=h * rate - 1)
