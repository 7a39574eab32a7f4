"""Frictional systems, advanced step by step by equation (7), and masses with friction as one of them.

A `MassSpringSystem` is a row of masses on one axis,

    M ü + C u̇ + K u = F(t) + W λ_T,        |λ_T| <= μ_s N(t) at rest,   λ_T = −μ_k N(t) sign ġ_T in motion,

with springs, dashpots and dry friction between any two masses, ġ_T = Wᵀ u̇, and normal forces N(t) and forces F(t) that
are given: constants, sines, what grows evenly, and pieces of these one after the other. Instead of a mass or the ground
there may be a `Motion` at the other end of a spring, or under a contact: a base, a belt. Read as moments of inertia,
angles and moments, it is a drive train with clutches and brakes.
"""

import dataclasses
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from reference_lcp.chain.trajectory import Trajectory
from reference_lcp.errors import ParameterError, shown
from reference_lcp.lcp.time_step import FrictionalStep, solved_steps
from reference_lcp.validation import FloatArray, checked_array, checked_count, checked_scalar

SINGULAR = 1e-12
"""Part of the largest eigenvalue below which one is zero but for round-off."""

SAME_TIME = 4 * 2.0**-52
"""Part of a time within which it is that of a switch: k dt and the time that a user wrote differ by roundings."""


@dataclass(frozen=True)
class Harmonic:
    """The force F(t) = F_0 + r t + A sin(ωt + φ)."""

    mean: float = 0.0
    """F_0 [N]."""
    amplitude: float = 0.0
    """A [N]."""
    angular_frequency: float = 0.0
    """ω [rad/s], >= 0."""
    phase: float = 0.0
    """φ [rad]."""
    rate: float = 0.0
    """r [N/s]."""

    def __post_init__(self) -> None:
        for name in ("mean", "amplitude", "phase", "rate"):
            checked_scalar(name, getattr(self, name))
        checked_scalar("angular_frequency", self.angular_frequency, ">= 0")

    def value(self, time: float) -> float:
        """F(t) [N] at `time` [s]."""
        return self.mean + self.rate * time + self.amplitude * math.sin(self.angular_frequency * time + self.phase)


@dataclass(frozen=True)
class Motion:
    """The given motion x(t) = v t + A sin(ωt + φ) of a base, of the end of a spring, or of a belt."""

    velocity: float = 0.0
    """v [m/s]."""
    amplitude: float = 0.0
    """A [m]."""
    angular_frequency: float = 0.0
    """ω [rad/s], >= 0."""
    phase: float = 0.0
    """φ [rad]."""

    def __post_init__(self) -> None:
        self.position()

    def position(self, factor: float = 1.0) -> Harmonic:
        """x(t) times a factor, as that of a spring on the force at its other end."""
        turning = self.angular_frequency, self.phase
        return Harmonic(0.0, factor * self.amplitude, *turning, factor * self.velocity)

    def speed(self, factor: float = 1.0) -> Harmonic:
        """ẋ(t) times a factor."""
        swing = factor * self.amplitude * self.angular_frequency
        return Harmonic(factor * self.velocity, swing, self.angular_frequency, self.phase + math.pi / 2)


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

    @property
    def harmonics(self) -> tuple[Harmonic, ...]:
        """The pieces, in their order."""
        return tuple(map(_harmonic, self.pieces.values()))

    def piece(self, time: float) -> Harmonic:
        """Give what holds at `time` [s], and just behind it."""
        begun = [piece for start, piece in self.pieces.items() if start <= time + SAME_TIME * abs(time)]
        return _harmonic(begun[-1] if begun else next(iter(self.pieces.values())))

    def value(self, time: float) -> float:
        """F(t) [N] at `time` [s], of the later piece where it switches."""
        return self.piece(time).value(time)


Signal = Piecewise | Harmonic | float
"""A force as a user may give it [N]."""


def piecewise(signal: Signal, name: str = "force") -> Piecewise:
    """Give any signal as pieces; what is none is refused by this name."""
    return signal if isinstance(signal, Piecewise) else Piecewise({0.0: _harmonic(signal, name)})


def _harmonic(piece: Harmonic | float, name: str = "force") -> Harmonic:
    if isinstance(piece, Harmonic):
        return piece
    if callable(piece):
        raise ParameterError(
            f"{name} = {shown(piece)} is any function; allowed: a number, Harmonic, or Piecewise of both"
        )
    return Harmonic(mean=checked_scalar(name, piece))


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


def simulate_system(
    system: FrictionalSystem,
    *,
    position: ArrayLike,
    velocity: ArrayLike,
    time_step: float,
    steps: int,
    start: int = 0,
) -> Trajectory:
    """Advance `system` by equations (5) and (7), Lemke's method in every step; where N is given, gaps are NaN.

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
    gaps, slip, coefficient = np.empty(contact), np.empty(contact), np.zeros(system.contacts)
    record = Trajectory(
        time=dt * ends, positions=np.empty(motion), velocities=np.empty(motion), friction=np.empty(contact),
        normal_force=np.empty(contact), normal_gap=gaps, slip=slip, friction_coefficient=coefficient,
    )  # fmt: skip

    def step_from(index: int, u: FloatArray, q: FloatArray) -> FrictionalStep:
        step = system.step(dt * index, u, q, dt)
        coefficient[:] = step.friction_coefficient
        return step

    steps_of_motion = solved_steps(step_from, range(first, first + ends.size), u, q)
    for row, (position_at_end, velocity_at_end, impulses) in enumerate(steps_of_motion):
        record.positions[row], record.velocities[row] = position_at_end, velocity_at_end
        record.normal_force[row], record.friction[row] = impulses.normal / dt, impulses.tangential / dt
        gaps[row] = np.nan if impulses.normal_gap is None else impulses.normal_gap
        slip[row] = impulses.relative_velocity
    return record


@dataclass(frozen=True)
class Spring:
    """A spring with a dashpot between two bodies, or between one and the ground."""

    first: int
    """Index of a body."""
    second: int | Motion | None = None
    """Index of the other one; ``None`` is the ground, and a `Motion` ground that moves."""
    stiffness: float = 0.0
    """k [N/m], >= 0."""
    damping: float = 0.0
    """c [N s/m], >= 0."""


@dataclass(frozen=True)
class FrictionContact:
    """Dry friction between two bodies, or between one and the ground, with a given normal force."""

    first: int
    """Index of the body whose velocity relative to the second one is ġ_T."""
    second: int | Motion | None = None
    """Index of the other one; ``None`` is the ground, and a `Motion` ground that moves, such as a belt."""
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
        self.loads, self.normal_signals  # noqa: B018 - forces that are none are refused here
        if self.contacts and np.linalg.matrix_rank(self.directions) < self.contacts:
            ranks = [np.linalg.matrix_rank(self.directions[:, : k + 1]) for k in range(self.contacts)]
            last = next(k for k, rank in enumerate(ranks) if rank <= k)
            raise ParameterError(
                f"{self.contacts} contacts join bodies in a ring, which contact {last} closes at body "
                f"{self.friction[last].first}; allowed: contacts whose slips are independent"
            )

    def _check_bodies(self, what: str, first: int, second: int | Motion | None) -> None:
        for body in (first, second):
            if not (body is None or isinstance(body, Motion) or body in range(self.freedoms)):
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
        names = (f"normal force of contact {place}" for place in range(self.contacts))
        return tuple(piecewise(own.normal_force, name) for own, name in zip(self.friction, names, strict=True))

    @cached_property
    def loads(self) -> tuple[tuple[int, Piecewise], ...]:
        """Bodies and forces on them: those that are given, and those of the springs whose other end moves."""
        given = [(body, piecewise(force, f"force on body {body}")) for body, force in self.forces.items()]
        moved = [(own, own.second) for own in self.springs if isinstance(own.second, Motion)]
        pulled = [(own.first, piecewise(end.position(own.stiffness))) for own, end in moved if own.stiffness]
        return (*given, *pulled, *[(own.first, piecewise(end.speed(own.damping))) for own, end in moved if own.damping])

    @cached_property
    def surface_speeds(self) -> tuple[Harmonic, ...]:
        """Velocity of the ground under every contact [m/s]; zero where it stands, or there is a body."""
        return tuple(own.second.speed() if isinstance(own.second, Motion) else Harmonic() for own in self.friction)

    @cached_property
    def friction_bound(self) -> FloatArray:
        """Largest mean of μ_k N(t) of every contact [N], shape (c,)."""
        means = [max(piece.mean for piece in signal.harmonics) for signal in self.normal_signals]
        return self.friction_coefficient * np.array(means, dtype=np.float64)

    @cached_property
    def contact_mass(self) -> FloatArray:
        """Mass that a contact has to move where no other holds [kg], shape (c,)."""
        return 1 / np.sum(self.directions**2 / self.masses[:, None], axis=0)

    @cached_property
    def highest_natural_frequency(self) -> float:
        """Of the system without friction [rad/s]."""
        return float(np.sqrt(np.linalg.norm(self.per_mass(self.stiffness_matrix), 2)))

    @property
    def damped(self) -> bool:
        """Whether dashpots resist every motion."""
        rates = np.linalg.eigvalsh(self.per_mass(self.damping_matrix))
        return bool(rates[0] > SINGULAR * rates[-1])

    @property
    def one_coefficient(self) -> bool:
        """Whether friction at rest is that of motion."""
        return bool(np.array_equal(self.friction_coefficient, self.static_friction_coefficient))

    def per_mass(self, matrix: FloatArray) -> FloatArray:
        """M^-½ A M^-½, shape (f, f), whose eigenvalues are those of M⁻¹ A."""
        scales = 1 / np.sqrt(self.masses)
        return scales[:, None] * matrix * scales

    def force(self, time: float, position: FloatArray, velocity: FloatArray) -> FloatArray:
        """All forces but friction: h = F(t) − K u − C u̇ [N], shape (f,)."""
        force: FloatArray = -self.stiffness_matrix @ position - self.damping_matrix @ velocity
        for body, signal in self.loads:
            force[body] += signal.value(time)
        return force

    def step(self, time: float, position: FloatArray, velocity: FloatArray, time_step: float) -> FrictionalStep:
        """Equation (7)'s data for the step that starts at `time` [s]; N(t) is given, and that of its start."""
        step = FrictionalStep.under_normal_force(
            self.directions,
            velocity,
            mass_matrix=self.mass_matrix,
            force=self.force(time, position, velocity),
            time_step=time_step,
            friction_coefficient=self.friction_coefficient,
            static_friction_coefficient=self.static_friction_coefficient,
            normal_force=np.array([signal.value(time) for signal in self.normal_signals]),
        )
        if not any(isinstance(contact.second, Motion) for contact in self.friction):
            return step
        now, then = (np.array([own.value(t) for own in self.surface_speeds]) for t in (time, time + time_step))
        slip = step.relative_velocity - now
        return dataclasses.replace(step, relative_velocity=slip, tangential_motion=(now - then) / time_step)

    def _assembled(self, coefficients: Sequence[float]) -> FloatArray:
        """Matrix of what acts in proportion to each spring's elongation, or its rate."""
        directions = _incidence(self.freedoms, self.springs)
        return directions * np.array(coefficients, dtype=np.float64) @ directions.T


def _incidence(bodies: int, pairs: Sequence[Spring | FrictionContact]) -> FloatArray:
    """One for the first body of every pair, minus one for the second, shape (bodies, pairs)."""
    matrix = np.zeros((bodies, len(pairs)))
    for column, pair in enumerate(pairs):
        matrix[pair.first, column] = 1.0
        if not (pair.second is None or isinstance(pair.second, Motion)):
            matrix[pair.second, column] = -1.0
    return matrix


def _static(contact: FrictionContact) -> float:
    return contact.coefficient if contact.static_coefficient is None else contact.static_coefficient
