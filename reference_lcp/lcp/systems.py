"""Frictional systems, advanced step by step by equation (7), and masses with friction as one of them.

A `MassSpringSystem` is a row of masses on one axis,

    M ü + C u̇ + K u = F(t) + W λ_T,        |λ_T| <= μ_s N(t) at rest,   λ_T = −μ_k N(t) sign ġ_T in motion,

with springs, dashpots and dry friction between any two masses, ġ_T = Wᵀ u̇, and normal forces N(t) and forces F(t) that
are given: constants, sines, and pieces of both one after the other. Read as moments of inertia, angles and moments, it
is a drive train with clutches and brakes.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from reference_lcp.errors import ParameterError
from reference_lcp.lcp.time_step import FrictionalStep, solved_steps
from reference_lcp.validation import FloatArray, checked_array, checked_count, checked_scalar

SAME_TIME = 4 * 2.0**-52
"""Part of a time within which it is that of a switch: k dt and the time that a user wrote differ by roundings."""


@dataclass(frozen=True)
class Harmonic:
    """The force F(t) = F_0 + A sin(ωt + φ)."""

    mean: float = 0.0
    """F_0 [N]."""
    amplitude: float = 0.0
    """A [N]."""
    angular_frequency: float = 0.0
    """ω [rad/s], >= 0."""
    phase: float = 0.0
    """φ [rad]."""

    def __post_init__(self) -> None:
        for name in ("mean", "amplitude", "phase"):
            checked_scalar(name, getattr(self, name))
        checked_scalar("angular_frequency", self.angular_frequency, ">= 0")

    def value(self, time: float) -> float:
        """F(t) [N] at `time` [s]."""
        return self.mean + self.amplitude * math.sin(self.angular_frequency * time + self.phase)


@dataclass(frozen=True)
class Piecewise:
    """A force that switches from one function of time to the next.

    Raises
    ------
    ParameterError
        If there is no piece, or times do not rise.
    """

    pieces: Mapping[float, Harmonic | float]
    """Each `Harmonic`, or constant [N], by the time [s] from which on it holds, in rising order.

    The first is that of all earlier times too. A piece keeps the time of the whole: φ is the phase at t = 0.
    """

    def __post_init__(self) -> None:
        starts = [checked_scalar("start of a piece", start) for start in self.pieces]
        if not starts or starts != sorted(set(starts)):
            raise ParameterError(f"starts of pieces = {starts}; allowed: one or more, in rising order")
        object.__setattr__(self, "pieces", {t: _harmonic(piece) for t, piece in self.pieces.items()})

    @property
    def switches(self) -> tuple[float, ...]:
        """Times from which another piece holds [s], in rising order."""
        return tuple(self.pieces)[1:]

    def piece(self, time: float) -> Harmonic:
        """Give what holds at `time` [s], and just behind it."""
        begun = [piece for start, piece in self.pieces.items() if start <= time + SAME_TIME * abs(time)]
        return _harmonic(begun[-1] if begun else next(iter(self.pieces.values())))

    def value(self, time: float) -> float:
        """F(t) [N] at `time` [s], of the later piece where it switches."""
        return self.piece(time).value(time)


Signal = Piecewise | Harmonic | float
"""A force as a user may give it [N]."""


def piecewise(signal: Signal) -> Piecewise:
    """Give any signal as pieces."""
    return signal if isinstance(signal, Piecewise) else Piecewise({0.0: signal})


def _harmonic(piece: Harmonic | float) -> Harmonic:
    return piece if isinstance(piece, Harmonic) else Harmonic(mean=checked_scalar("force", piece))


class FrictionalSystem(Protocol):
    """Anything with unilateral frictional contacts that gives the data of equation (7).

    M, h, the gaps and the directions may depend on time, position and velocity, and are those of the start of the
    step. Normal forces are resolved, unless the step gives them.
    """

    @property
    def freedoms(self) -> int:
        """Number of freedoms f."""
        ...

    @property
    def contacts(self) -> int:
        """Number of contacts c."""
        ...

    def step(self, time: float, position: FloatArray, velocity: FloatArray, time_step: float) -> FrictionalStep:
        """Give the data of the step that starts at `time` [s] with `position` and `velocity`, shape (f,)."""
        ...


@dataclass(frozen=True)
class SystemTrajectory:
    """The motion of a frictional system over consecutive steps; row k belongs to the end of step k."""

    time: FloatArray
    """Ends of the steps [s], shape (steps,)."""
    positions: FloatArray
    """u, shape (steps, f)."""
    velocities: FloatArray
    """q, shape (steps, f)."""
    normal_force: FloatArray
    """λ_N >= 0 [N] during the step, shape (steps, c)."""
    friction: FloatArray
    """λ_T [N] during the step, shape (steps, c)."""
    normal_gap: FloatArray
    """g_N [m] as equation (6) gives it, shape (steps, c); NaN where the normal force is given."""
    relative_velocity: FloatArray
    """ġ_T [m/s] as equation (6) gives it, shape (steps, c)."""


def simulate_system(
    system: FrictionalSystem,
    *,
    position: ArrayLike,
    velocity: ArrayLike,
    time_step: float,
    steps: int,
    start: int = 0,
) -> SystemTrajectory:
    """Advance `system` by equations (5) and (7), Lemke's method in every step.

    Parameters
    ----------
    system
        What moves.
    position, velocity
        u and q at the start, shape (f,).
    time_step
        Δt [s], > 0.
    steps
        Number of steps, >= 1.
    start
        Index of the first step, >= 0: the motion starts at time ``start * time_step``.

    Raises
    ------
    StepFailed
        If the LCP of a step is not solved; the message names the step and its time.
    ParameterError
        If an argument is outside its range or does not fit the system.
    """
    dt = checked_scalar("time_step", time_step, "> 0")
    state, shape = {"position": position, "velocity": velocity}, (system.freedoms,)
    u, q = (checked_array(name, value, shape=shape).copy() for name, value in state.items())
    first = checked_count("start", start, 0)
    ends = np.arange(first + 1, first + checked_count("steps", steps) + 1, dtype=np.float64)
    motion, contact = (ends.size, system.freedoms), (ends.size, system.contacts)
    record = SystemTrajectory(dt * ends, *(np.empty(shape) for shape in (motion, motion, *[contact] * 4)))
    steps_of_motion = solved_steps(
        lambda index, u, q: system.step(dt * index, u, q, dt), range(first, first + ends.size), u, q
    )
    for row, (position_at_end, velocity_at_end, impulses) in enumerate(steps_of_motion):
        record.positions[row], record.velocities[row] = position_at_end, velocity_at_end
        record.normal_force[row], record.friction[row] = impulses.normal / dt, impulses.tangential / dt
        record.normal_gap[row] = np.nan if impulses.normal_gap is None else impulses.normal_gap
        record.relative_velocity[row] = impulses.relative_velocity
    return record


@dataclass(frozen=True)
class Spring:
    """A spring with a dashpot between two bodies, or between one and the ground."""

    first: int
    """Index of a body."""
    second: int | None = None
    """Index of the other one; ``None`` is the ground."""
    stiffness: float = 0.0
    """k [N/m], >= 0."""
    damping: float = 0.0
    """c [N s/m], >= 0."""


@dataclass(frozen=True)
class FrictionContact:
    """Dry friction between two bodies, or between one and the ground, with a given normal force."""

    first: int
    """Index of the body whose velocity relative to the second one is ġ_T."""
    second: int | None = None
    """Index of the other one; ``None`` is the ground."""
    normal_force: Signal = 0.0
    """N(t) [N], >= 0 at all times of a motion."""
    coefficient: float = 0.0
    """μ_k of a contact in motion, >= 0."""
    static_coefficient: float | None = None
    """μ_s >= μ_k of one at rest; without it, μ_k."""


@dataclass(frozen=True, eq=False, kw_only=True)
class MassSpringSystem:
    """Masses, springs, dashpots and friction contacts; a `FrictionalSystem`.

    Raises
    ------
    ParameterError
        If a value is outside its range, a body does not exist, or contacts join bodies in a ring, so that friction
        at rest would not be determined.
    """

    masses: FloatArray
    """m [kg], > 0, one a body."""
    springs: Sequence[Spring] = ()
    friction: Sequence[FrictionContact] = ()
    forces: Mapping[int, Signal] = field(default_factory=dict)
    """F(t) [N] by the index of the body on which it acts."""

    def __post_init__(self) -> None:
        masses = np.atleast_1d(checked_array("masses", self.masses, "> 0"))
        object.__setattr__(self, "masses", masses)
        for spring in self.springs:
            self._check_bodies("spring", spring.first, spring.second)
            checked_scalar("stiffness", spring.stiffness, ">= 0")
            checked_scalar("damping", spring.damping, ">= 0")
        for contact in self.friction:
            self._check_bodies("contact", contact.first, contact.second)
            kinetic = checked_scalar("coefficient", contact.coefficient, ">= 0")
            if checked_scalar("static_coefficient", _static(contact), ">= 0") < kinetic:
                raise ParameterError(
                    f"static_coefficient = {contact.static_coefficient:g}; allowed: >= coefficient, {kinetic:g}"
                )
        for body in self.forces:
            self._check_bodies("force", body, None)
        if self.contacts and np.linalg.matrix_rank(self.directions) < self.contacts:
            raise ParameterError(
                f"{self.contacts} contacts join bodies in a ring; allowed: contacts whose slips are independent"
            )

    def _check_bodies(self, what: str, first: int, second: int | None) -> None:
        for body in (first, second):
            if body is not None and body not in range(self.freedoms):
                raise ParameterError(f"body = {body!r} of a {what} does not exist; allowed: 0 to {self.freedoms - 1}")
        if first == second:
            raise ParameterError(f"a {what} joins body {first} to itself; allowed: two bodies, or one and the ground")

    @property
    def freedoms(self) -> int:
        """Number of bodies."""
        return self.masses.shape[0]

    @property
    def contacts(self) -> int:
        """Number of contacts c."""
        return len(self.friction)

    @cached_property
    def mass_matrix(self) -> FloatArray:
        """M [kg], shape (f, f)."""
        return np.diag(self.masses)

    @cached_property
    def stiffness_matrix(self) -> FloatArray:
        """K [N/m], shape (f, f)."""
        return self._assembled([spring.stiffness for spring in self.springs])

    @cached_property
    def damping_matrix(self) -> FloatArray:
        """C [N s/m], shape (f, f)."""
        return self._assembled([spring.damping for spring in self.springs])

    @cached_property
    def directions(self) -> FloatArray:
        """W, with ġ_T = Wᵀ u̇, shape (f, c)."""
        return _incidence(self.freedoms, self.friction)

    @cached_property
    def friction_coefficient(self) -> FloatArray:
        """μ_k, shape (c,)."""
        return np.array([contact.coefficient for contact in self.friction], dtype=np.float64)

    @cached_property
    def static_friction_coefficient(self) -> FloatArray:
        """μ_s, shape (c,)."""
        return np.array([_static(contact) for contact in self.friction], dtype=np.float64)

    @cached_property
    def normal_signals(self) -> tuple[Piecewise, ...]:
        """N(t) of every contact."""
        return tuple(piecewise(contact.normal_force) for contact in self.friction)

    @cached_property
    def force_signals(self) -> Mapping[int, Piecewise]:
        """F(t) by body."""
        return {body: piecewise(force) for body, force in self.forces.items()}

    def force(self, time: float, position: FloatArray, velocity: FloatArray) -> FloatArray:
        """All forces but friction: h = F(t) − K u − C u̇ [N], shape (f,)."""
        force: FloatArray = -self.stiffness_matrix @ position - self.damping_matrix @ velocity
        for body, signal in self.force_signals.items():
            force[body] += signal.value(time)
        return force

    def step(self, time: float, position: FloatArray, velocity: FloatArray, time_step: float) -> FrictionalStep:
        """Equation (7)'s data for the step that starts at `time` [s]; N(t) is given, and that of its start."""
        return FrictionalStep.under_normal_force(
            self.directions,
            velocity,
            mass_matrix=self.mass_matrix,
            force=self.force(time, position, velocity),
            time_step=time_step,
            friction_coefficient=self.friction_coefficient,
            static_friction_coefficient=self.static_friction_coefficient,
            normal_force=np.array([signal.value(time) for signal in self.normal_signals]),
        )

    def _assembled(self, coefficients: Sequence[float]) -> FloatArray:
        """Matrix of what acts in proportion to each spring's elongation, or its rate."""
        directions = _incidence(self.freedoms, self.springs)
        return directions * np.array(coefficients, dtype=np.float64) @ directions.T


def _incidence(bodies: int, pairs: Sequence[Spring | FrictionContact]) -> FloatArray:
    """One for the first body of every pair, minus one for the second, shape (bodies, pairs)."""
    matrix = np.zeros((bodies, len(pairs)))
    for column, pair in enumerate(pairs):
        matrix[pair.first, column] = 1.0
        if pair.second is not None:
            matrix[pair.second, column] = -1.0
    return matrix


def _static(contact: FrictionContact) -> float:
    return contact.coefficient if contact.static_coefficient is None else contact.static_coefficient
