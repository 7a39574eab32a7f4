"""Masses and springs with one dry contact under harmonic forces of one frequency, and what is linear about them."""

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from reference_lcp.errors import ParameterError
from reference_lcp.lcp.systems import Harmonic, MassSpringSystem, Piecewise
from reference_lcp.validation import FloatArray


@dataclass(frozen=True, eq=False)
class OneContact:
    """M ẍ + C ẋ + K x = Im(f exp(iωt)) − F w sgn ẏ, with y = wᵀ x and f freedoms.

    A chain on a moving base with friction against a wall has the force k U0 sin ωt on its first mass. With friction
    against the base its displacements x are taken relative to that, and every mass has the force m ω² U0 sin ωt.
    """

    mass_matrix: FloatArray
    stiffness_matrix: FloatArray
    damping_matrix: FloatArray
    direction: FloatArray
    """w, shape (f,)."""
    force: NDArray[np.complex128]
    """f [N], shape (f,)."""
    friction: float
    """F [N], of the contact in motion."""
    angular_frequency: float
    """ω [rad/s]."""

    @classmethod
    def of(cls, system: MassSpringSystem) -> Self:
        """Read a system.

        Raises
        ------
        ParameterError
            If it has no or several contacts with friction, more friction at rest than in motion, a normal force that
            changes, forces that are no sines of one frequency, a contact with moving ground, or a body that is tied to
            nothing.
        """
        rubs = [k for k, contact in enumerate(system.friction) if contact.coefficient and contact.normal_force]
        which = rubs or list(range(system.contacts))
        if len(which) != 1:
            raise ParameterError(f"contacts with friction = {len(which)}; allowed: 1, for a closed form")
        contact, normal, w = system.friction[which[0]], system.normal_signals[which[0]], system.directions[:, which[0]]
        if system.static_friction_coefficient[which[0]] > contact.coefficient:
            raise ParameterError(
                f"static_coefficient = {contact.static_coefficient:g}; allowed: coefficient, {contact.coefficient:g}"
            )
        if len(normal.pieces) > 1 or normal.piece(0.0).amplitude or normal.piece(0.0).rate:
            raise ParameterError(f"normal_force = {contact.normal_force}; allowed: a constant, for a closed form")
        if system.surface_speeds[which[0]] != Harmonic():
            raise ParameterError(
                f"second = {contact.second} of the contact; allowed: a body or still ground, "
                "with displacements relative to it"
            )
        omega, force = _harmonic_forces(system)
        weakest = np.linalg.eigvalsh(system.stiffness_matrix)[0]
        if weakest <= 1e-12 * np.max(np.abs(system.stiffness_matrix), initial=0.0):
            raise ParameterError(
                f"stiffness of the softest motion = {weakest:g} N/m; allowed: > 0, springs to the ground"
            )
        return cls(
            system.mass_matrix, system.stiffness_matrix, system.damping_matrix, w, force,
            contact.coefficient * normal.piece(0.0).mean, omega,
        )  # fmt: skip

    @property
    def freedoms(self) -> int:
        """Number of bodies f."""
        return self.direction.size

    @cached_property
    def response(self) -> NDArray[np.complex128]:
        """X [m] without friction, shape (f,)."""
        return self._linear(self.force)

    @cached_property
    def friction_response(self) -> NDArray[np.complex128]:
        """Response to a unit force along w [m/N], shape (f,)."""
        return self._linear(self.direction)

    @property
    def relative_response(self) -> complex:
        """Y = wᵀ X [m]."""
        return complex(self.direction @ self.response)

    @property
    def locked_friction(self) -> float:
        """Amplitude [N] of the force that holds the contact: it never slides where friction is larger."""
        pushed, moved = self.relative_response, complex(self.direction @ self.friction_response)
        return abs(pushed / moved) if moved else np.inf

    def _linear(self, force: NDArray[np.generic]) -> NDArray[np.complex128]:
        omega = self.angular_frequency
        dynamic = self.stiffness_matrix + 1j * omega * self.damping_matrix - omega**2 * self.mass_matrix
        return np.asarray(np.linalg.solve(dynamic, force.astype(np.complex128)))


def _harmonic_forces(system: MassSpringSystem) -> tuple[float, NDArray[np.complex128]]:
    """Give ω and f of forces that are sines of one frequency, A sin(ωt + φ)."""
    force, frequencies = np.zeros(system.freedoms, dtype=np.complex128), set()
    for body, signal in system.loads:
        piece = signal.piece(0.0)
        if len(signal.pieces) > 1 or piece.mean or piece.rate:
            raise ParameterError(f"force on body {body} = {_shown(signal)}; allowed: A sin(ωt + φ), for a closed form")
        if piece.amplitude:
            frequencies.add(piece.angular_frequency)
            force[body] += piece.amplitude * np.exp(1j * piece.phase)
    if len(frequencies) != 1 or min(frequencies) == 0:
        raise ParameterError(f"angular frequencies of forces = {sorted(frequencies)} rad/s; allowed: one, > 0")
    return frequencies.pop(), force


def _shown(signal: Piecewise) -> str:
    return "pieces" if len(signal.pieces) > 1 else str(signal.piece(0.0))
