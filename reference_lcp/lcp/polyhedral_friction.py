"""Friction in the plane of a contact, its cone replaced by a pyramid: a time step as a linear complementarity problem.

Coulomb's friction in a plane is bounded by a circle, |λ_T| <= μ λ_N, which no linear complementarity problem has. With
directions d_1 … d_m in the plane, m even and evenly spaced, friction is a sum Σ β_j d_j with β_j >= 0 and
Σ β_j <= μ Λ_N: a regular polygon whose corners are on the circle. With the slip s = W_Tᵀ q⁺ and a multiplier σ,

    0 <= Λ_N ⟂ g_N / Δt + W_Nᵀ q⁺ >= 0,    0 <= β_j ⟂ σ + d_jᵀ s >= 0,    0 <= σ ⟂ μ Λ_N − Σ β_j >= 0.

Stewart and Trinkle, Int. J. Numer. Methods Eng. 39 (1996) 2673; Anitescu and Potra, Nonlinear Dynamics 14 (1997) 231.
With δ the angle from the nearest corner, a contact sticks up to μ λ_N cos(π/m) / cos(π/m − δ), and one that slips has
the friction of that corner, with the part μ λ_N cos δ against the slip.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from reference_lcp.errors import ParameterError
from reference_lcp.lcp.lemke import lemke
from reference_lcp.lcp.time_step import PATHS, StepFailed, check_step
from reference_lcp.validation import FloatArray, checked_count

LEAST_FACETS = 4
"""Facets of a pyramid that bounds friction in every direction, in pairs."""


@dataclass(frozen=True, kw_only=True)
class PolyhedralStep:
    """Everything that one step of a system with c contacts takes from its start."""

    mass_matrix: FloatArray
    """M, shape (f, f), symmetric positive definite."""
    force: FloatArray
    """h, all forces but those of the contacts [N], shape (f,)."""
    velocity: FloatArray
    """q at the start of the step, shape (f,)."""
    time_step: float
    """Δt [s]."""
    normal_directions: FloatArray
    """W_N, shape (f, c)."""
    tangential_directions: FloatArray
    """W_T, shape (f, 2c): two perpendicular tangents of the first contact, then of the next."""
    normal_gap: FloatArray
    """g_N at the start of the step [m], shape (c,)."""
    friction_coefficient: FloatArray
    """μ >= 0, shape (c,)."""
    facets: int
    """m, even, >= 4; the first corner is on the first tangent."""

    def __post_init__(self) -> None:
        if checked_count("facets", self.facets, LEAST_FACETS) % 2:
            raise ParameterError(f"facets = {self.facets} is odd; allowed: even numbers from {LEAST_FACETS} on")
        shapes = {"mass_matrix": "ff", "force": "f", "velocity": "f", "normal_directions": "fc"}
        check_step(self, shapes | {"tangential_directions": "ft", "normal_gap": "c"})

    @property
    def contacts(self) -> int:
        """Number of contacts c."""
        return self.normal_gap.shape[0]

    @cached_property
    def corners(self) -> FloatArray:
        """Directions d_j in the two tangents of every contact, shape (2c, m c)."""
        angles = 2 * np.pi * np.arange(self.facets) / self.facets
        return np.kron(np.eye(self.contacts), np.stack([np.cos(angles), np.sin(angles)]))


@dataclass(frozen=True)
class PolyhedralImpulses:
    """What the contacts do in one step."""

    normal: FloatArray
    """Λ_N [N s], shape (c,)."""
    tangential: FloatArray
    """Friction's impulse in the two tangents of every contact [N s], shape (c, 2)."""
    velocity: FloatArray
    """q at the end of the step, shape (f,)."""
    slip: FloatArray
    """s at the end of the step [m/s], shape (c, 2)."""


def solve_polyhedral_step(step: PolyhedralStep) -> PolyhedralImpulses:
    """Solve a step by Lemke's method.

    Raises
    ------
    StepFailed
        If none of the paths of Lemke's method ends with a solution.
    """
    count = step.contacts
    directions = np.hstack([step.normal_directions, step.tangential_directions @ step.corners])
    responses = np.linalg.solve(step.mass_matrix, np.hstack([directions, step.force[:, None]]))
    free = step.velocity + step.time_step * responses[:, -1]
    result = lemke(*_assembled(step, directions.T @ responses[:, :-1], directions.T @ free), paths=PATHS)
    if not result.solved:
        raise StepFailed(f"the LCP of the step is not solved: {result.status} after {result.pivots} pivots")
    impulses = result.z[:-count]
    velocity = free + responses[:, :-1] @ impulses
    tangential = step.corners @ impulses[count:]
    slip = step.tangential_directions.T @ velocity
    return PolyhedralImpulses(impulses[:count], tangential.reshape(count, 2), velocity, slip.reshape(count, 2))


def _assembled(step: PolyhedralStep, coupling: FloatArray, free: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Matrix and vector of the unknowns (Λ_N, β, σ), from Dᵀ M⁻¹ D and Dᵀ q of a step without contacts."""
    count = step.contacts
    ones = np.kron(np.eye(count), np.ones((step.facets, 1)))
    none = np.zeros((count, count))
    bounds = np.hstack([np.diag(step.friction_coefficient), -ones.T, none])
    matrix = np.vstack([np.hstack([coupling, np.vstack([none, ones])]), bounds])
    return matrix, np.concatenate([free[:count] + step.normal_gap / step.time_step, free[count:], np.zeros(count)])
