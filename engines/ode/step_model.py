"""The laws of ODE in SI units: its softness, and springs of its own in an implicit Euler step."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from multibody_xval.engines.interface.law import Constant, Law
from multibody_xval.engines.interface.presets import Preset
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.schemes.linear_implicit import LinearImplicitLane, LinearStep, ScalarFriction

TILTED_PERIOD = 1e-7
"""Of U0: measured are up to 7e-9, of chains of unequal masses, with coefficients of friction below `TIPPING`."""

TIPPING = 1.0
"""Coefficient of friction from which on a box is about to tip over its edge: friction times its height is then the
normal force times its width. Measured are up to 4e-6 U0 from the law with 1, and 3e-4 with 3."""


def soft_motors(preset: Preset) -> Law:
    """Give the law of motors as friction beside springs as forces."""
    formula = "equation (5), with Coulomb's law softened: (Wᵀ M⁻¹ W)_ii + cfm / h"
    return _softened(formula, preset, LinearStep.explicit)


def soft_stops(preset: Preset) -> Law:
    """Give the law of stops as springs: they are solved together with friction."""
    formula = (
        "(M + h C + h² K) q̇⁺ = M q̇ − h K q + h f(t) e_1 + W p; "
        "Coulomb's law, softened: (Wᵀ (M + h C + h² K)⁻¹ W)_ii + cfm / h"
    )
    return _softened(formula, preset, LinearStep.implicit)


def soft_boxes(preset: Preset) -> Law:
    """Give the law of boxes on plates: four points share the load, and friction."""
    formula = "equation (5), with Coulomb's law softened by four points: (Wᵀ M⁻¹ W)_ii + cfm / (4 h)"
    law = _softened(formula, preset, LinearStep.explicit, points=4)
    return replace(
        law,
        constants={"cfm": replace(law.constants["cfm"], too_small_to_see=True)},
        period_bound=TILTED_PERIOD,
        bound_reason="four soft points let round-off tilt a box, which opens one or the other of them for a step",
        unmodelled_reason=_unmodelled_box,
    )


def _unmodelled_box(lane: Lane) -> str | None:
    """Say why boxes do something else in a lane; ``None`` if they do not."""
    if lane.direction:
        return "both tangents of the world carry friction in a row that is turned"
    if np.any(lane.chain.friction_coefficient >= TIPPING):
        return f"boxes are about to tip over their edges from a friction coefficient of {TIPPING:g} on"
    return None


def _softened(formula: str, preset: Preset, step: Callable[[Chain, float], LinearStep], points: int = 1) -> Law:
    def model(lane: Lane, of: Mapping[str, float]) -> LinearImplicitLane:
        friction = ScalarFriction.coulomb(lane.chain.cells, of["cfm"] / points / lane.time_step)
        return LinearImplicitLane(lane, step(lane.chain, lane.time_step), friction)

    constants = {"cfm": Constant(preset["cfm"], "m/(s N)", "cfm")}
    return Law(formula=formula, constants=constants, model=model, modulated=True)
