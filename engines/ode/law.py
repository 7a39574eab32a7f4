"""The laws of ODE in SI units: its softness, and springs of its own in an implicit Euler step."""

from collections.abc import Callable

from multibody_xval.engines.interface.laws import Constant, Law, Step
from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.linear_law import LinearStep, linear_law, soft_coulomb
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane

TILTED_PERIOD = 1e-7
"""Of U0: measured are up to 7e-9, of chains of unequal masses. From a coefficient of friction of 1 on, boxes tip over
their edges, for friction times their height is the normal force times their width: 4e-6 with 1, and 3e-4 with 3."""


def soft_motors(preset: Preset) -> Law:
    """Give the law of motors as friction beside springs as forces."""
    return Law(
        formula="equation (5), with Coulomb's law softened: (Wᵀ M⁻¹ W)_ii + cfm / h",
        constants={"cfm": Constant(preset["cfm"], "m/(s N)", "cfm")},
        step=lambda lane, of: _softened(lane, LinearStep.explicit, of["cfm"]),
    )


def soft_stops(preset: Preset) -> Law:
    """Give the law of stops as springs: they are solved together with friction."""
    return Law(
        formula=(
            "(M + h C + h² K) q̇⁺ = M q̇ − h K q + h f(t) e_1 + W p; "
            "Coulomb's law, softened: (Wᵀ (M + h C + h² K)⁻¹ W)_ii + cfm / h"
        ),
        constants={"cfm": Constant(preset["cfm"], "m/(s N)", "cfm")},
        step=lambda lane, of: _softened(lane, LinearStep.implicit, of["cfm"]),
    )


def soft_boxes(preset: Preset) -> Law:
    """Give the law of boxes on plates: four points share the load, and friction."""
    softness = preset["cfm"] / 4
    return Law(
        formula=f"equation (5), with Coulomb's law softened by four points: (Wᵀ M⁻¹ W)_ii + {softness:g} m/(s N) / h",
        step=lambda lane, _: _softened(lane, LinearStep.explicit, softness),
        bound=TILTED_PERIOD,
        bound_reason="four soft points let round-off tilt a box, which opens one or the other of them for a step",
    )


def _softened(lane: Lane, linear: Callable[[Chain, float], LinearStep], softness: float) -> Step:
    """Solve friction with a softness [m/(s N)] in a step of springs, dashpots and load."""
    return linear_law(lane, linear(lane.chain, lane.time_step), soft_coulomb(softness / lane.time_step))


LAWS = {
    "joint:recommended": soft_motors,
    "joint:default": soft_motors,
    "joint:stops": soft_stops,
    "contact:default": soft_boxes,
}
"""By formulation and preset."""
