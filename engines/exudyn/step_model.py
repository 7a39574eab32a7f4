"""Exudyn's steps as models: a zone, a disc or a bristle in every contact, in the substeps of its implicit integrator.

A substep of length h begins with positions q, velocities v, accelerations a and the algorithmic accelerations ã, and
ends with

    b = −α_m/(1−α_m) ã + α_f/(1−α_m) a,
    q⁺ = q + h v + h² ((½−β) ã + β (b + c a⁺)),   v⁺ = v + h ((1−γ) ã + γ (b + c a⁺)),   ã⁺ = b + c a⁺,
    M a⁺ + C v⁺ + K q⁺ + W φ⁺ = f(t+h) e_1,

with c = (1−α_f)/(1−α_m) and φ = −λ the forces of the connectors. A run begins with ã = a, those of its first state.

The end of a substep has elongations x = v_i − u_i and slip velocities w, of which the forces φ of the contacts take
their part: x = x_free − P φ, w = w_free − V φ. What contacts keep from one substep to the next, shape (2, n), is
nothing for a zone; for a disc the slip velocity of the last correction; for a bristle the force of its slip, 0 in
stick, and the place of its foot.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from multibody_xval.engines.interface.law import Constant, Law, NotModelled
from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.kernel_lane import KernelLane
from multibody_xval.engines.shared.units import Units
from reference_lcp.chain.drives import HarmonicBase, HarmonicForce
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.schemes.linear_implicit import padded_rows
from reference_lcp.validation import FloatArray

ZONE, DISC, BRISTLE = 0, 1, 2
"""Kinds of contacts."""

DISC_CORRECTIONS = 5
"""Exudyn's own discontinuous.maxIterations: the fifth correction is taken, whatever its error."""

SPECTRAL_RADIUS = 0.9
"""Of generalised alpha at infinite frequency: Exudyn's own, which no preset sets."""

TRAPEZOIDAL = (0.0, 0.0, 1.0, 0.25, 0.5)
"""−α_m/(1−α_m), α_f/(1−α_m), c, β and γ of Newmark's rule."""

ACCELERATED = 10.0
"""Displacement scales that the accelerations of a period make, every one taken in one direction: a substep whose Newton
iteration stops at a part of its first residual errs by at most that part of them."""

STOPS = "Newton's iteration stops at the relative tolerance"

SMALLEST_VELOCITY = 0.01
"""What differences are at least taken from [m/s], in the units of a lane: Exudyn's minimumCoordinateSize."""


def zone(preset: Preset) -> Law:
    """Give the law of connectors with a zone: a fixed one may be so narrow that Newton's iteration fails."""
    iterated = "frictionProportionalZone" in preset.options
    return _zone_law(preset, ZONE, "φ = F clip(w / z, ±1), w at the end of a substep", iterated)


def disc(preset: Preset) -> Law | NotModelled:
    """Give the law of discs whose zone is linear; friction that falls again leaves to the iteration where it ends."""
    correction = "w_d the slip velocity of the last of up to five corrections"
    if preset["useLinearProportionalZone"]:
        return _zone_law(preset, DISC, f"φ = F w / z if |w_d| ≤ z, else F sgn w_d, {correction}", False)
    formula = f"φ = F s (2 - |s|), s = w / z, if |w_d| ≤ z, else F sgn w_d, {correction}"
    return NotModelled(
        "friction s (2 − s) falls again beyond the zone, so that a step has several solutions: Newton's iteration, on "
        "its way to one of them, magnifies last digits, and a model of it predicts most periods, but not all",
        nearly=_zone_law(preset, DISC, formula, True),
    )


def _zone_law(preset: Preset, kind: int, formula: str, iterated: bool) -> Law:
    """Give the law of a zone of friction, with the width of the zone and the integrator."""

    def model(lane: Lane, constants: Mapping[str, float]) -> "GeneralisedAlphaLane":
        force = Units.in_steps(preset["units"], lane).force
        tolerance = preset["discontinuous_tolerance"] * force if kind == DISC else 0.0
        numbers = step_rule(constants), kind, zone_widths(lane, preset, constants)
        return (NewtonLane if iterated else GeneralisedAlphaLane)(lane, preset, *numbers, tolerance=tolerance)

    width = "" if "frictionProportionalZone" in preset.options else "z = max(z_s s ω_r, z_k F h / m_red); "
    path = "by Newton's iteration, and substeps that are halved where it fails; " if iterated else ""
    law = _law(preset, f"{formula}; {width}{path}{_steps(preset)}", _constants(preset), model)
    return replace(law, settles=not iterated)


def _law(
    preset: Preset, formula: str, constants: Mapping[str, Constant], model: Callable[..., "GeneralisedAlphaLane"]
) -> Law:
    bound = ACCELERATED * preset["relative_tolerance"]
    return Law(formula=formula, constants=constants, model=model, period_bound=bound, bound_reason=STOPS)


def bristle(preset: Preset) -> Law | NotModelled:
    """Give the law of bristles that are corrected once a step."""
    if preset["discontinuous_iterations"] != 1:
        return NotModelled(
            "a reversal is repeated in stick with the force at exactly its bound, and round-off decides whether that "
            "is slip: in up to half of the steps"
        )

    given = "stickingStiffness" in preset.options

    def model(lane: Lane, constants: Mapping[str, float]) -> "BristleModelLane":
        if given:
            springs = np.full(lane.chain.cells, constants["k_s"]), np.full(lane.chain.cells, constants["d_s"])
        else:
            phase_and_damping = constants["θ"], constants["ζ"]
            springs = bristle_numbers(lane.chain, lane.time_step, preset["substeps"], *phase_and_damping)
        return BristleModelLane(lane, preset, step_rule(constants), BRISTLE, *springs)

    formula = (
        f"stick: φ = k_s (x − foot) + d_s w, {'' if given else 'k_s = m_red (θ / h)², d_s = 2 ζ √(k_s m_red), '}"
        f"until |φ| > F after a substep; slip: φ = F sgn w, until w has reversed after a substep; {_steps(preset)}"
    )
    if given:
        constants = {
            "k_s": Constant(preset["stickingStiffness"], "N/m", "stickingStiffness", ideal=math.inf),
            "d_s": Constant(preset["stickingDamping"], "N s/m", "stickingDamping", ideal=math.inf),
        }
    else:
        constants = {
            "θ": Constant(preset["bristle_phase"], "", "bristle_phase, and so stickingStiffness"),
            "ζ": Constant(preset["bristle_damping"], "", "bristle_damping, and so stickingDamping"),
        }
    constants |= _integrator(preset)
    return _law(preset, formula, constants, model)


def zone_widths(lane: Lane, preset: Preset, constants: Mapping[str, float] | None = None) -> FloatArray:
    """Give the zones [m/s], shape (n,): as given, or so wide that friction neither creeps nor rings.

    Their constants are those of the preset where no others are given.
    """
    if constants is None:
        constants = {symbol: constant.value for symbol, constant in _constants(preset).items()}
    if "z" in constants:
        return np.full(lane.chain.cells, constants["z"])
    speed = lane.drive.displacement_scale(lane.chain) * lane.chain.resonator_frequency
    return np.maximum(constants["z_s"] * speed, constants["z_k"] * _kick(lane, preset))


def reduced_mass(chain: Chain) -> FloatArray:
    """Give m_red of every cell, shape (n,)."""
    return 1 / (1 / chain.outer_mass + 1 / chain.inner_mass)


def bristle_numbers(
    chain: Chain, time_step: float, substeps: int, phase: float, damping: float
) -> tuple[FloatArray, FloatArray]:
    """Give k_s and d_s of bristles whose oscillation has this phase in a substep, and this damping ratio."""
    mass = reduced_mass(chain)
    stiffness = mass * (phase * substeps / time_step) ** 2
    return stiffness, 2 * damping * np.sqrt(stiffness * mass)


def bristles_at(
    state: State, lane: Lane, load: float, stiffness: FloatArray, damping: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Give slip forces, 0 in stick, and deflections of the bristles of a state, shape (n,) each.

    Without an internal state a bristle holds the load that it meets: one that started unloaded would let go of a stuck
    contact and ring. A search of periodic orbits mixes slip forces of several periods: the nearest of 0 and ±μN is
    meant.
    """
    chain = lane.chain
    if state.internal_state is not None:
        slip, deflection = np.split(state.internal_state[0], 2)
        slips = np.abs(slip) > chain.friction_bound / 2
        return np.where(slips, np.copysign(chain.friction_bound, slip), 0.0), deflection
    position, velocity = state.positions[0], state.velocities[0]
    pull = -chain.stiffness_matrix @ position - chain.damping_matrix @ velocity
    pull[0] += load
    outer, inner = np.split(pull / np.diag(chain.mass_matrix), 2)
    holding = (inner - outer) / (1 / chain.outer_mass + 1 / chain.inner_mass)
    force = holding + damping * (chain.contact_directions.T @ velocity)
    slips = np.abs(force) >= lane.static_ratio * chain.friction_bound
    return np.where(slips, np.copysign(chain.friction_bound, force), 0.0), np.where(slips, 0.0, holding / stiffness)


class GeneralisedAlphaLane(KernelLane):
    """One chain under one drive, advanced as Exudyn does; contacts keep no more than their slip velocity.

    `rule` is as `TRAPEZOIDAL`. `first`, shape (n,), is the width of the zone [m/s] or the stiffness of the bristles
    [N/m], `second` their dashpots [N s/m]; `tolerance` the error of the force [N] at which a disc is corrected no more.
    """

    def __init__(
        self,
        lane: Lane,
        preset: Preset,
        rule: tuple[float, ...],
        kind: int,
        first: FloatArray,
        second: FloatArray | float = 0.0,
        tolerance: float = 0.0,
    ):
        super().__init__(lane)
        chain, substeps, self._preset = lane.chain, preset["substeps"], preset
        h = lane.time_step / substeps
        self._numbers = np.vstack([chain.friction_bound, first, np.broadcast_to(second, first.shape)])
        self._kind, self._tolerance, self._rule = kind, tolerance, (h, substeps, *rule)
        place, speed = rule[2] * h * h * rule[3], rule[2] * h * rule[4]
        inverse = np.linalg.inv(chain.mass_matrix + speed * chain.damping_matrix + place * chain.stiffness_matrix)
        directions = chain.contact_directions.T
        rows = -chain.stiffness_matrix @ inverse, -chain.damping_matrix @ inverse, inverse[:1], 0 * inverse[:1]
        made = np.vstack([*rows, directions @ inverse])
        at, moving = (np.eye(len(made), len(inverse), -before) for before in (0, len(inverse)))
        self._inverse_mass = np.linalg.inv(chain.mass_matrix)
        self._made = padded_rows(made)
        self._shapes = np.stack([directions @ (at + place * made).T, directions @ (moving + speed * made).T])

    def _integrate(self, state: State, start: int, steps: int, record: FloatArray) -> State:
        """Run the kernel; a run begins with new accelerations, as Exudyn's do."""
        from multibody_xval.engines.exudyn.step_kernel import advance, forces  # numba is imported once something moves

        lane, (length, parts) = self.lane, self._rule[:2]
        times = length * np.arange(start * parts, (start + steps) * parts + 1, dtype=np.float64)
        loads = lane.drive.load(lane.chain, times)
        whole = np.concatenate([state.positions[0], state.velocities[0], [0.0, 1.0]])
        motion, contacts = whole[:-2].reshape(2, -1), self._contacts_at(state, float(loads[0]))
        first = self._accelerations(motion, forces(motion, contacts, self._kind, self._numbers), float(loads[0]))
        accelerations = np.pad(first, (0, self._made.shape[1] - first.size))
        rules = self._made, self._shapes, self._rule, self._kind, self._numbers, self._tolerance
        advance(whole, motion, contacts, accelerations, loads, *rules, record)
        return State(motion[:1], motion[1:], self._internal_state(motion[0], contacts))

    def _accelerations(self, motion: FloatArray, forces: FloatArray, load: float) -> FloatArray:
        """Give the accelerations of a state, whose contacts have forces φ."""
        chain = self.lane.chain
        elastic = chain.stiffness_matrix @ motion[0] + chain.damping_matrix @ motion[1]
        rest = -(elastic + chain.contact_directions @ forces)
        rest[0] += load
        return self._inverse_mass @ rest

    def _contacts_at(self, state: State, load: float) -> FloatArray:
        """Give what contacts keep at the start of a run, shape (2, n), with `load` [N] on cell 1."""
        slip = self.lane.chain.contact_directions.T @ state.velocities[0]
        return np.vstack([slip, np.zeros_like(slip)])

    def _internal_state(self, positions: FloatArray, contacts: FloatArray) -> FloatArray | None:
        """Give the internal state at the end of a run, shape (1, k)."""
        return None


class NewtonLane(GeneralisedAlphaLane):
    """The same by Exudyn's own Newton iteration, whose path decides where equations have no solution, or several."""

    def _integrate(self, state: State, start: int, steps: int, record: FloatArray) -> State:
        from multibody_xval.engines.exudyn.newton_kernel import advance, frictions

        lane, (length, parts), parabolic = self.lane, self._rule[:2], self._kind == DISC
        first = start * parts
        loads = lane.drive.load(lane.chain, length * np.arange(first, first + steps * parts + 1, dtype=np.float64))
        wave = np.array([*(harmonic_amplitudes(lane) or (0.0, 0.0, 0.0)), length * first])
        slip = self._contacts_at(state, float(loads[0]))
        motion = np.vstack([state.positions[0], state.velocities[0], slip.ravel()])
        forces = frictions(slip[0], slip[0], self._numbers, parabolic)
        accelerations = self._accelerations(motion, forces, float(loads[0]))
        numbers = self._numbers, self._limits
        advance(motion, accelerations, loads, wave, self._chain, np.array(self._rule), parabolic, *numbers, record)
        return State(motion[:1], motion[1:2])

    @cached_property
    def _chain(self) -> FloatArray:
        chain = self.lane.chain
        return np.stack([chain.mass_matrix, chain.damping_matrix, chain.stiffness_matrix])

    @cached_property
    def _limits(self) -> FloatArray:
        """Give the limits of the kernel."""
        preset, units = self._preset, Units.in_steps(self._preset["units"], self.lane)
        tolerances = preset["relative_tolerance"], preset["absolute_tolerance"] * units.force
        smallest = SMALLEST_VELOCITY * units.velocity, self._tolerance, preset["smallest_step"] * preset["substeps"]
        return np.array([*tolerances, *smallest])


class BristleModelLane(GeneralisedAlphaLane):
    """Contacts keep the force of their slip and the place of their foot; states hold the deflection instead."""

    def _contacts_at(self, state: State, load: float) -> FloatArray:
        slip, deflection = bristles_at(state, self.lane, load, *self._numbers[1:])
        return np.vstack([slip, self._elongation(state.positions[0]) - deflection])

    def _internal_state(self, positions: FloatArray, contacts: FloatArray) -> FloatArray:
        return np.concatenate([contacts[0], self._elongation(positions) - contacts[1]])[None]

    def _elongation(self, positions: FloatArray) -> FloatArray:
        return self.lane.chain.contact_directions.T @ positions


def _steps(preset: Preset) -> str:
    rule = "trapezoidal rule" if preset["solver"] == "Newmark" else "generalised alpha of spectral radius ρ"
    return f"{rule}, substeps h = dt / {preset['substeps']}"


def _constants(preset: Preset) -> dict[str, Constant]:
    """Give the constants of a zone and of the integrator."""
    if "frictionProportionalZone" in preset.options:
        constants = {"z": Constant(preset["frictionProportionalZone"], "m/s", "frictionProportionalZone", ideal=0.0)}
    else:
        constants = {
            "z_s": Constant(preset["zone"], "", "zone, and so frictionProportionalZone"),
            "z_k": Constant(preset["zone_per_kick"], "", "zone_per_kick, and so frictionProportionalZone"),
        }
    return constants | _integrator(preset)


def _integrator(preset: Preset) -> dict[str, Constant]:
    """Give the constants of the integrator."""
    if preset["solver"] == "Newmark":
        return {}
    return {"ρ": Constant(SPECTRAL_RADIUS, "", "generalizedAlpha.spectralRadius, Exudyn's own")}


def step_rule(constants: Mapping[str, float]) -> tuple[float, ...]:
    """Give the trapezoidal rule, or generalised alpha of spectral radius ρ (Chung and Hulbert, 1993)."""
    if "ρ" not in constants:
        return TRAPEZOIDAL
    radius = constants["ρ"]
    mass, force = (2 * radius - 1) / (radius + 1), radius / (radius + 1)
    gamma = 0.5 + force - mass
    rest = 1 - mass
    return -mass / rest, force / rest, (1 - force) / rest, 0.25 * (gamma + 0.5) ** 2, gamma


def _kick(lane: Lane, preset: Preset) -> FloatArray:
    """Slip velocity [m/s] that the bound of friction at rest makes in a substep, shape (n,)."""
    chain = lane.chain
    kick: FloatArray = lane.static_ratio * chain.friction_bound * (1 / chain.outer_mass + 1 / chain.inner_mass)
    return kick * lane.time_step / preset["substeps"]


def harmonic_amplitudes(lane: Lane) -> tuple[float, float, float] | None:
    """Sine and cosine amplitude [N] and ω [rad/s] of the force on cell 1, ``None`` for other drives."""
    drive: Any = lane.drive
    if type(drive) is HarmonicForce:
        return drive.amplitude, 0.0, drive.angular_frequency
    if type(drive) is HarmonicBase:
        chain: Chain = lane.chain
        spring = float(chain.chain_stiffness[0]) * drive.amplitude
        dashpot = float(chain.chain_damping[0]) * drive.amplitude * drive.angular_frequency
        return spring, dashpot, drive.angular_frequency
    return None
