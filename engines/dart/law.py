"""The laws of DART: its own springs in an implicit Euler step, and spheres that are a little soft."""

from collections.abc import Mapping

from engines.interface.law import Constant, Law
from engines.interface.presets import Preset
from engines.shared.tangents import tangents_of_the_world
from reference_lcp.chain.simulation import Lane
from reference_lcp.stepping.linear_implicit import LinearImplicitLane, LinearStep, ScalarFriction

OWN_SPRINGS_PERIOD = 1e-12
"""Of U0: 400 steps of some ten roundings of 1e-16, each of U0. A hundredth of DART's softness is above it."""

SPHERE_PERIOD = 2e-6
"""Of U0: in the first step of a run a sphere presses, and rubs, by a part of 1e-5 less."""


def own_springs(preset: Preset) -> Law:
    """Give the law of the joints' own springs."""
    mixing = Constant(preset["constraint force mixing"], "", "constraint force mixing")
    return Law(
        formula=(
            "(M + h C + h² K) q̇_free = M q̇ − h K q + h f(t) e_1; q̇⁺ = q̇_free + M⁻¹ W p; "
            "Coulomb's law, softened by the part ε of (Wᵀ M⁻¹ W)_ii"
        ),
        constants={"ε": mixing},
        model=_own_springs,
        period_bound=OWN_SPRINGS_PERIOD,
        modulated=True,
    )


def soft_sphere(preset: Preset) -> Law:
    """Give the law of a sphere on a plate, whose one point of contact is soft."""
    source = "DART's constraint force mixing of a point of contact, which Python cannot set"
    compliance = Constant(preset.residual_slip_compliance, "", source, too_small_to_see=True)
    return Law(
        formula=(
            "equation (5), with Coulomb's law softened by the part ε of (Wᵀ M⁻¹ W)_ii; in a row that is turned by α "
            "the bound is (|cos α| + |sin α|) μ λ_N"
        ),
        constants={"ε": compliance},
        model=_soft_sphere,
        period_bound=SPHERE_PERIOD,
        bound_reason="the normal force is as soft: in the first step of a run it lacks a part of 1e-5",
        modulated=True,
    )


def _own_springs(lane: Lane, constants: Mapping[str, float]) -> LinearImplicitLane:
    step = LinearStep.implicit(lane.chain, lane.time_step, response_matrix=lane.chain.mass_matrix)
    return _softened(lane, step, constants["ε"])


def _soft_sphere(lane: Lane, constants: Mapping[str, float]) -> LinearImplicitLane:
    step, bound = LinearStep.explicit(lane.chain, lane.time_step), tangents_of_the_world(lane)
    return _softened(lane, step, constants["ε"], bound_share=bound)


def _softened(lane: Lane, step: LinearStep, part: float, bound_share: float = 1.0) -> LinearImplicitLane:
    compliance = part * step.coupling.diagonal()
    return LinearImplicitLane(lane, step, ScalarFriction.coulomb(lane.chain.cells, compliance, bound_share=bound_share))
