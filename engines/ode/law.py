"""The laws of ODE in SI units: its softness, and springs of its own in an implicit Euler step."""

from collections.abc import Mapping

from engines.interface.law import Constant, Law
from engines.interface.presets import Preset
from engines.ode.inclined import NormalFirstLane
from reference_lcp.chain.simulation import Lane
from reference_lcp.stepping.linear_implicit import LinearImplicitLane, LinearStep, ScalarFriction

POINTS = 4
"""Points of contact of a box on its plate."""

TILTED_PERIOD = 1e-7
"""Of U0: measured are up to 7e-9, of chains of unequal masses."""

TILTED_REASON = "four soft points let round-off tilt a box, which opens one or the other of them for a step"


def soft_motors(preset: Preset) -> Law:
    """Give the law of motors as friction beside springs as forces."""
    return Law(
        formula="equation (5), with Coulomb's law softened: (Wᵀ M⁻¹ W)_ii + cfm / h",
        constants={"cfm": _softness(preset)},
        model=_soft_motors,
        modulated=True,
    )


def soft_stops(preset: Preset) -> Law:
    """Give the law of stops as springs: they are solved together with friction."""
    return Law(
        formula=(
            "(M + h C + h² K) q̇⁺ = M q̇ − h K q + h f(t) e_1 + W p; "
            "Coulomb's law, softened: (Wᵀ (M + h C + h² K)⁻¹ W)_ii + cfm / h"
        ),
        constants={"cfm": _softness(preset)},
        model=_soft_stops,
        modulated=True,
    )


def normal_first(preset: Preset) -> Law:
    """Give the law of spheres on plates that are inclined to the row."""
    options = preset.modulated()
    return Law(
        formula=(
            "equation (7) with bounds that know no friction: 0 <= Λ⁰ ⟂ n·v_free + A_nn Λ⁰ − e (z − l)⁺ / h >= 0, then "
            "|Λ_T| <= μ Λ⁰ against the slip while 0 <= Λ_N ⟂ n·v⁺ − e (z − l)⁺ / h >= 0; contacts at depths z > 0"
        ),
        constants={
            "e": Constant(options["erp"], "", "erp"),
            "l": Constant(options["surface_layer"], "", "surface_layer, over s"),
            "z": Constant(options["depth"], "", "depth at no gap, over s"),
        },
        model=_normal_first,
        modulated=True,
        lifting=True,
        inclines=True,
    )


def soft_boxes(preset: Preset) -> Law:
    """Give the law of boxes on plates: four points share the load, and friction."""
    return Law(
        formula="equation (5), with Coulomb's law softened by four points: (Wᵀ M⁻¹ W)_ii + cfm / (4 h)",
        constants={"cfm": Constant(preset["cfm"], "m/(s N)", "cfm", too_small_to_see=True)},
        model=_soft_boxes,
        period_bound=TILTED_PERIOD,
        bound_reason=TILTED_REASON,
        modulated=True,
        unmodelled_reason=_turned,
    )


def _turned(lane: Lane) -> str | None:
    return "both tangents of the world carry friction in a row that is turned" if lane.direction else None


def _soft_boxes(lane: Lane, constants: Mapping[str, float]) -> LinearImplicitLane:
    return _softened(lane, LinearStep.explicit(lane.chain, lane.time_step), {"cfm": constants["cfm"] / POINTS})


def _normal_first(lane: Lane, constants: Mapping[str, float]) -> NormalFirstLane:
    return NormalFirstLane(lane, erp=constants["e"], layer=constants["l"], depth=constants["z"])


def _softness(preset: Preset) -> Constant:
    return Constant(preset["cfm"], "m/(s N)", "cfm")


def _soft_motors(lane: Lane, constants: Mapping[str, float]) -> LinearImplicitLane:
    return _softened(lane, LinearStep.explicit(lane.chain, lane.time_step), constants)


def _soft_stops(lane: Lane, constants: Mapping[str, float]) -> LinearImplicitLane:
    return _softened(lane, LinearStep.implicit(lane.chain, lane.time_step), constants)


def _softened(lane: Lane, step: LinearStep, constants: Mapping[str, float]) -> LinearImplicitLane:
    compliance = constants["cfm"] / lane.time_step
    return LinearImplicitLane(lane, step, ScalarFriction.coulomb(lane.chain.cells, compliance))
