"""The laws of ODE in SI units: its softness, and springs of its own in an implicit Euler step."""

from multibody_xval.engines.interface.laws import Constant, Law
from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.linear_law import LinearStep, linear_law, soft_coulomb

TILTED_PERIOD = 1e-7
"""Of U0: measured are up to 7e-9, of chains of unequal masses. From a coefficient of friction of 1 on, boxes tip over
their edges, for friction times their height is the normal force times their width: 4e-6 with 1, and 3e-4 with 3."""


def soft_motors(preset: Preset) -> Law:
    """Give the law of motors as friction beside springs as forces."""
    return Law(
        formula="equation (5), with Coulomb's law softened: (Wᵀ M⁻¹ W)_ii + cfm / h",
        constants={"cfm": Constant(preset["cfm"], "m/(s N)", "cfm")},
        step=lambda lane, of: linear_law(
            lane, LinearStep.explicit(lane.chain, lane.time_step), soft_coulomb(of["cfm"] / lane.time_step)
        ),
    )


def soft_stops(preset: Preset) -> Law:
    """Give the law of stops as springs: they are solved together with friction."""
    return Law(
        formula=(
            "(M + h C + h² K) q̇⁺ = M q̇ − h K q + h f(t) e_1 + W p; "
            "Coulomb's law, softened: (Wᵀ (M + h C + h² K)⁻¹ W)_ii + cfm / h"
        ),
        constants={"cfm": Constant(preset["cfm"], "m/(s N)", "cfm")},
        step=lambda lane, of: linear_law(
            lane, LinearStep.implicit(lane.chain, lane.time_step), soft_coulomb(of["cfm"] / lane.time_step)
        ),
    )


def soft_boxes(preset: Preset) -> Law:
    """Give the law of boxes on plates: four points share the load, and friction."""
    softness = preset["cfm"] / 4
    return Law(
        formula=f"equation (5), with Coulomb's law softened by four points: (Wᵀ M⁻¹ W)_ii + {softness:g} m/(s N) / h",
        step=lambda lane, _: linear_law(
            lane, LinearStep.explicit(lane.chain, lane.time_step), soft_coulomb(softness / lane.time_step)
        ),
        bound=TILTED_PERIOD,
        bound_reason="four soft points let round-off tilt a box, which opens one or the other of them for a step",
    )


LAWS = {
    "joint:recommended": soft_motors,
    "joint:default": soft_motors,
    "joint:stops": soft_stops,
    "contact:default": soft_boxes,
}
"""By formulation and preset."""
