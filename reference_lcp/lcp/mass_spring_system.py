"""Masses on one axis with springs, dashpots and dry friction between any two of them, under given forces.

    M ü + C u̇ + K u = F(t) + W λ_T,        |λ_T| <= μ_s N(t) at rest,   λ_T = −μ_k N(t) sign ġ_T in motion,

with ġ_T = Wᵀ u̇, and normal forces N(t) and forces F(t) that are given. Read as moments of inertia, angles and
moments, it is a drive train with clutches and brakes.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from reference_lcp.lcp.signal import Piecewise, Signal, piecewise
from reference_lcp.lcp.time_step import FrictionalStep
from reference_lcp.refusal import ParameterError
from reference_lcp.validation import FloatArray, checked_array, checked_scalar


@dataclass(frozen=True)
class Spring:
    """A spring with a dashpot between two bodies, or between one and the ground.

    Parameters
    ----------
    first, second
        Indices of the bodies; ``None`` is the ground.
    stiffness, damping
        k [N/m] and c [N s/m], >= 0.
    """

    first: int
    second: int | None = None
    stiffness: float = 0.0
    damping: float = 0.0


@dataclass(frozen=True)
class FrictionContact:
    """Dry friction between two bodies, or between one and the ground, with a given normal force.

    Parameters
    ----------
    first, second
        Indices of the bodies; ``None`` is the ground. ġ_T is the velocity of the first relative to the second.
    normal_force
        N(t) [N], >= 0 at all times of a motion.
    coefficient
        μ_k of a contact in motion, >= 0.
    static_coefficient
        μ_s >= μ_k of one at rest; without it, μ_k.
    """

    first: int
    second: int | None = None
    normal_force: Signal = 0.0
    coefficient: float = 0.0
    static_coefficient: float | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class MassSpringSystem:
    """Masses, springs, dashpots and friction contacts; a `FrictionalSystem`.

    Parameters
    ----------
    masses
        m [kg], > 0, one a body.
    springs, friction
        What acts between bodies.
    forces
        F(t) [N] by the index of the body on which it acts.

    Raises
    ------
    ParameterError
        If a value is outside its range, a body does not exist, or contacts join bodies in a ring, so that friction
        at rest would not be determined.
    """

    masses: FloatArray
    springs: Sequence[Spring] = ()
    friction: Sequence[FrictionContact] = ()
    forces: Mapping[int, Signal] = field(default_factory=dict)

    def __post_init__(self) -> None:
        masses = np.atleast_1d(checked_array("masses", self.masses, "> 0"))
        object.__setattr__(self, "masses", masses)
        for spring in self.springs:
            self._check_bodies("spring", spring.first, spring.second)
            checked_scalar("stiffness", spring.stiffness, ">= 0")
            checked_scalar("damping", spring.damping, ">= 0")
        for contact in self.friction:
            self._check_bodies("contact", contact.first, contact.second)
            _check_coefficients(contact)
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
        none, still = np.zeros((self.freedoms, self.contacts)), np.zeros(self.contacts)
        return FrictionalStep(
            mass_matrix=self.mass_matrix,
            force=self.force(time, position, velocity),
            velocity=velocity,
            time_step=time_step,
            normal_directions=none,
            tangential_directions=self.directions,
            tangential_directions_of_position=none,
            normal_motion=still,
            tangential_motion=still,
            normal_gap=still,
            relative_velocity=self.directions.T @ velocity,
            friction_coefficient=self.friction_coefficient,
            static_friction_coefficient=self.static_friction_coefficient,
            normal_force=np.array([signal.value(time) for signal in self.normal_signals]),
        )

    def _assembled(self, coefficients: Sequence[float]) -> FloatArray:
        """Matrix of what acts in proportion to each spring's elongation, or its rate."""
        directions = _incidence(self.freedoms, self.springs)
        matrix: FloatArray = directions * np.array(coefficients, dtype=np.float64) @ directions.T
        return matrix


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


def _check_coefficients(contact: FrictionContact) -> None:
    kinetic = checked_scalar("coefficient", contact.coefficient, ">= 0")
    if checked_scalar("static_coefficient", _static(contact), ">= 0") < kinetic:
        raise ParameterError(
            f"static_coefficient = {contact.static_coefficient:g}; allowed: >= coefficient, {kinetic:g}"
        )
