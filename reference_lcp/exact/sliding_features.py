"""What a dry contact makes of resonances, and where it changes no amplitude: features of curves of a sliding contact.

All are of systems without dashpots whose frequency is varied: a `Family` gives the system at a frequency [rad/s].
Den Hartog (1931) and Marino and Cicirello (2021), see `reference_lcp.exact.continuous_sliding`.
"""

import math
from collections.abc import Callable

import numpy as np
from scipy.linalg import eigh
from scipy.optimize import bisect

from reference_lcp.errors import ParameterError
from reference_lcp.exact.continuous_sliding import SquareWaveResponse
from reference_lcp.exact.one_contact import OneContact
from reference_lcp.lcp.systems import MassSpringSystem
from reference_lcp.validation import FloatArray, checked_count, checked_scalar

Family = Callable[[float], MassSpringSystem]
"""Gives the system whose forces have an angular frequency [rad/s]."""

ROOT = 1e-6
"""Part of the values around it that a function has at its root; at a pole, where its sign changes too, it is large."""


def bounding_friction(family: Family) -> tuple[FloatArray, FloatArray]:
    """Give natural frequencies [rad/s] without friction, and the friction [N] above which resonances are bounded.

    In a period forces feed π |φᵀ f| a into an amplitude a of the mode φ, and friction takes 4 F |φᵀ w| a, if a is so
    large that the mode alone moves the contact. Hence F = (π/4) |φᵀ f| / |φᵀ w|, infinite where it does not.

    Raises
    ------
    ParameterError
        If the system has dashpots, or is none of those of `OneContact`.
    """
    own = _undamped(family(1.0))
    squares, modes = eigh(own.stiffness_matrix, own.mass_matrix)
    frequencies = np.sqrt(squares)
    forces = np.array([OneContact.of(family(omega)).force for omega in frequencies.tolist()])
    pushed = np.abs(np.sum(forces * modes.T, axis=1))
    moved = np.abs(modes.T @ own.direction)
    with np.errstate(divide="ignore"):
        return frequencies, np.where(moved > 1e-12 * np.max(moved), math.pi / 4 * pushed / moved, np.inf)


def friction_effect(system: MassSpringSystem, body: int, *, moving: float = 0.0) -> float:
    """d|X|²/d(F²) of the fundamental amplitude of a body [m²/N²], the same for all F as long as the contact slides.

    Friction's part of the fundamental, F G exp(−iωt0) with G = −(4/π) H w, has a phase with cos ωt0 = −F ḣ(0) / (ωY),
    so that |X|² = X² + F² (G² − 2 X G ḣ(0) / (ωY)).

    Parameters
    ----------
    system
        Without dashpots, all forces in phase.
    body
        Index of the body.
    moving
        Amplitude [m] of what displacements are relative to, in phase with the forces: |X| is absolute then.
    """
    own = _undamped(system)
    if not 0 <= body < own.freedoms:
        raise ParameterError(f"body = {body!r}; allowed: 0 to {own.freedoms - 1}")
    if np.ptp(np.angle(own.force[own.force != 0]) % math.pi) > 1e-12:
        raise ParameterError("phases of the forces differ; allowed: one phase, or opposite ones")
    turn = SquareWaveResponse(own).turn
    phase = np.exp(-1j * np.angle(own.force[np.flatnonzero(own.force)[0]]))
    response = float(np.real(own.response[body] * phase)) + moving
    friction = -4 / math.pi * float(np.real(own.friction_response[body]))
    return friction * (friction - 2 * response * turn / float(np.real(own.relative_response * phase)))


def invariant_frequencies(
    family: Family, body: int, *, lowest: float, highest: float, moving: float = 0.0, points: int = 2000
) -> list[float]:
    """Angular frequencies [rad/s] at which the fundamental amplitude of a body is the same with any friction.

    That holds as long as the contact slides, see `largest_sliding_friction`.

    Parameters
    ----------
    family, body, moving
        As of `friction_effect`.
    lowest, highest
        Ends of the interval [rad/s] that is searched, > 0.
    points
        Of the grid, >= 2: of two such frequencies in one of its intervals none is found.
    """
    low = checked_scalar("lowest", lowest, "> 0")
    if checked_scalar("highest", highest, "> 0") <= low:
        raise ParameterError(f"highest = {highest:g} rad/s; allowed: above lowest, {low:g} rad/s")

    friction_effect(family(low), body, moving=moving)  # refuses what has no such frequencies

    def effect(omega: float) -> float:
        try:
            return friction_effect(family(omega), body, moving=moving)
        except (ParameterError, np.linalg.LinAlgError):
            return math.inf  # in resonance

    grid = np.linspace(low, highest, checked_count("points", points, 2))
    values = np.array([effect(omega) for omega in grid])
    found = []
    for k in np.flatnonzero(values[:-1] * values[1:] < 0).tolist():
        root = float(bisect(effect, grid[k], grid[k + 1], xtol=1e-14 * highest))
        if abs(effect(root)) < ROOT * max(abs(values[k]), abs(values[k + 1])):
            found.append(root)
    return found


def _undamped(system: MassSpringSystem) -> OneContact:
    own = OneContact.of(system)
    if np.any(own.damping_matrix):
        raise ParameterError(f"largest damping = {np.max(own.damping_matrix):g} N s/m; allowed: none")
    return own
