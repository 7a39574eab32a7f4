"""The laws of Exudyn's connectors and discs: a zone or a bristle, in the steps of its integrator."""

from collections.abc import Mapping

import numpy as np

from engines.exudyn.bristle_model import BristleModelLane
from engines.exudyn.friction_models import BRISTLE, DISC, ZONE, ContactNumbers
from engines.exudyn.generalised_alpha import GeneralisedAlphaLane, IntegrationRule
from engines.interface.law import Constant, Law, NotModelled
from engines.interface.presets import Preset
from engines.shared.units import Units
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray

SPECTRAL_RADIUS = 0.9
"""Of generalised alpha at infinite frequency: Exudyn's own, which no preset sets."""

ACCELERATED = 10.0
"""Displacement scales that the accelerations of a period make, every one taken in one direction: a substep whose Newton
iteration stops at a part of its first residual errs by at most that part of them."""

STOPS = "Newton's iteration stops at the relative tolerance"

FAILS = (
    "the kick F h / m_red of a step is wider than two zones: Newton's iteration may run in a circle between both sides "
    "of the zone, and where it fails Exudyn halves its steps, up to 0.03 displacement scales aside within a period"
)


def zone(preset: Preset) -> Law:
    """Give the law of connectors with a zone."""

    def model(lane: Lane, constants: Mapping[str, float]) -> GeneralisedAlphaLane:
        numbers = _zone_numbers(ZONE, lane, constants, preset)
        return GeneralisedAlphaLane(lane, _rule(constants), numbers, preset["substeps"])

    return Law(
        formula=f"φ = F clip(w / z, ±1), w at the end of a substep; {_terms(preset)}",
        constants=_constants(preset),
        model=model,
        period_bound=ACCELERATED * preset["relative_tolerance"],
        bound_reason=STOPS,
        unmodelled_reason=lambda lane: _failure_of_newton(lane, preset),
    )


def disc(preset: Preset) -> Law | NotModelled:
    """Give the law of discs whose zone is linear."""
    if not preset["useLinearProportionalZone"]:
        return NotModelled(
            "friction s (2 − s) falls again beyond the zone, until the next correction cuts it off: the equations of a "
            "step have several roots, and the path of Newton's iteration decides between them"
        )

    def model(lane: Lane, constants: Mapping[str, float]) -> GeneralisedAlphaLane:
        tolerance = preset["discontinuous_tolerance"] * Units.in_steps(preset["units"], lane).force
        numbers = _zone_numbers(DISC, lane, constants, preset, tolerance)
        return GeneralisedAlphaLane(lane, _rule(constants), numbers, preset["substeps"])

    return Law(
        formula=(
            "φ = F w / z if |w_d| ≤ z, else F sgn w_d, w_d the slip velocity of the last of up to five corrections; "
            f"{_terms(preset)}"
        ),
        constants=_constants(preset),
        model=model,
        period_bound=ACCELERATED * preset["relative_tolerance"],
        bound_reason=STOPS,
    )


def bristle(preset: Preset) -> Law | NotModelled:
    """Give the law of bristles that are corrected once a step."""
    if preset["discontinuous_iterations"] != 1:
        return NotModelled(
            "a reversal is repeated in stick with the force at exactly its bound, and round-off decides whether that "
            "is slip: in up to half of the steps"
        )

    def model(lane: Lane, constants: Mapping[str, float]) -> BristleModelLane:
        return BristleModelLane(
            lane, IntegrationRule.trapezoidal(), _bristle_numbers(lane, constants, preset), preset["substeps"]
        )

    return Law(
        formula=(
            "stick: φ = k_s (x − foot) + d_s w, k_s = m_red (θ / h)², d_s = 2 ζ √(k_s m_red), until |φ| > F after a "
            f"substep; slip: φ = F sgn w, until w has reversed after a substep; {_steps(preset)}"
        ),
        constants={
            "θ": Constant(preset["bristle_phase"], "", "bristle_phase, and so stickingStiffness"),
            "ζ": Constant(preset["bristle_damping"], "", "bristle_damping, and so stickingDamping"),
        },
        model=model,
        period_bound=ACCELERATED * preset["relative_tolerance"],
        bound_reason=STOPS,
    )


def _zone_numbers(
    kind: int, lane: Lane, constants: Mapping[str, float], preset: Preset, tolerance: float = 0.0
) -> ContactNumbers:
    width = _width(lane, constants, preset)
    return ContactNumbers(kind, lane.chain.friction_bound, width, np.zeros_like(width), tolerance)


def _bristle_numbers(lane: Lane, constants: Mapping[str, float], preset: Preset) -> ContactNumbers:
    chain = lane.chain
    mass = 1 / (1 / chain.outer_mass + 1 / chain.inner_mass)
    stiffness = mass * (constants["θ"] * preset["substeps"] / lane.time_step) ** 2
    damping = 2 * constants["ζ"] * np.sqrt(stiffness * mass)
    return ContactNumbers(BRISTLE, chain.friction_bound, stiffness, damping)


def _terms(preset: Preset) -> str:
    """Say what makes the zone and the steps."""
    width = "" if "frictionProportionalZone" in preset.options else "z = max(z_s s ω_r, z_k F h / m_red); "
    return width + _steps(preset)


def _steps(preset: Preset) -> str:
    rule = "trapezoidal rule" if preset["solver"] == "Newmark" else "generalised alpha of spectral radius ρ"
    return f"{rule}, substeps h = dt / {preset['substeps']}"


def _constants(preset: Preset) -> dict[str, Constant]:
    """Give the constants of a zone and of the integrator."""
    if "frictionProportionalZone" in preset.options:
        constants = {"z": Constant(preset["frictionProportionalZone"], "m/s", "frictionProportionalZone")}
    else:
        constants = {
            "z_s": Constant(preset["zone"], "", "zone, and so frictionProportionalZone"),
            "z_k": Constant(preset["zone_per_kick"], "", "zone_per_kick, and so frictionProportionalZone"),
        }
    if preset["solver"] != "Newmark":
        constants["ρ"] = Constant(SPECTRAL_RADIUS, "", "generalizedAlpha.spectralRadius, Exudyn's own")
    return constants


def _rule(constants: Mapping[str, float]) -> IntegrationRule:
    return IntegrationRule.of_radius(constants["ρ"]) if "ρ" in constants else IntegrationRule.trapezoidal()


def _width(lane: Lane, constants: Mapping[str, float], preset: Preset) -> FloatArray:
    """Width of the zone [m/s], shape (n,)."""
    if "z" in constants:
        return np.full(lane.chain.cells, constants["z"])
    speed = lane.drive.displacement_scale(lane.chain) * lane.chain.resonator_frequency
    return np.maximum(constants["z_s"] * speed, constants["z_k"] * _kick(lane, preset))


def _kick(lane: Lane, preset: Preset) -> FloatArray:
    """Slip velocity [m/s] that the bound of friction makes in a substep, shape (n,)."""
    chain = lane.chain
    kick: FloatArray = chain.friction_bound * (1 / chain.outer_mass + 1 / chain.inner_mass)
    return kick * lane.time_step / preset["substeps"]


def _failure_of_newton(lane: Lane, preset: Preset) -> str | None:
    """Say where Newton's iteration may fail: half a kick then leads from one side of the zone beyond the other."""
    values = {symbol: constant.value for symbol, constant in _constants(preset).items()}
    fails = np.any(_kick(lane, preset) > 2 * _width(lane, values, preset))
    return FAILS if fails else None
