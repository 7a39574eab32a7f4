"""Equation (7): one time step of a frictional system as a linear complementarity problem.

The equations follow from (3), (5) and (6) of the paper; where its print has lost marks, this module
follows the derivation:

- g_T of (6b) is the relative *velocity* at the start of the step, and h is evaluated there too;
- the unknowns are (Λ_N Δt, Λ_TR Δt, ġ_T⁻ Δt), their complements (g_N, ġ_T⁺ Δt, Λ_TL Δt) at the
  end of the step: the print gives both parts of the relative velocity the same symbol;
- C_T = (W_Tᵀ + W̃_Tᵀ Δt) M⁻¹ h Δt + W̃_Tᵀ q Δt + ω̃_T Δt + g_T: the print has an undefined
  G_T h Δt, and W_Tᵀ q Δt without the tilde.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from reference_lcp.lcp.lemke import LemkeResult, lemke
from reference_lcp.refusal import ParameterError
from reference_lcp.validation import FloatArray, checked_array, checked_scalar

PATHS = 8
"""Paths of Lemke's method that a step tries: where the first ends without a solution, another may have one.

Equation (7) is of no class for which one path is enough: where friction lets a pressed contact approach all the more,
a path may end on a ray beside a solution.
"""


class StepFailed(RuntimeError):
    """The complementarity problem of a step has not been solved; the message has the status of Lemke's path."""


@dataclass(frozen=True, kw_only=True)
class FrictionalStep:
    """Everything that equation (7) takes from the start of one step of a system with c contacts.

    Parameters
    ----------
    mass_matrix
        M, shape (f, f), symmetric positive definite.
    force
        h, all forces but those of the contacts [N], shape (f,), at the start of the step.
    velocity
        q = u̇ at the start of the step, shape (f,).
    time_step
        Δt [s].
    normal_directions, tangential_directions
        W_N and W_T, shape (f, c).
    tangential_directions_of_position
        W̃_T = (∂ġ_T/∂u)ᵀ [1/s], shape (f, c).
    normal_motion
        ω̃_N = ∂g_N/∂t [m/s], shape (c,): a surface that moves along the normal.
    tangential_motion
        ω̃_T = ∂ġ_T/∂t [m/s²], shape (c,): a surface whose tangential velocity changes.
    normal_gap
        g_N at the start of the step [m], shape (c,).
    relative_velocity
        ġ_T at the start of the step [m/s], shape (c,), the velocity of moving surfaces included.
    friction_coefficient
        μ, shape (c,); of contacts in motion, where friction at rest is another.
    static_friction_coefficient
        μ_s >= μ of contacts at rest, shape (c,), see `reference_lcp.lcp.static_friction`; ``None`` where it is μ.
    normal_force
        λ_N [N] >= 0 where it is given, shape (c,); ``None`` where the step resolves it.

    Raises
    ------
    ParameterError
        If a value is not finite or outside its range, or a shape does not fit.
    """

    mass_matrix: FloatArray
    force: FloatArray
    velocity: FloatArray
    time_step: float
    normal_directions: FloatArray
    tangential_directions: FloatArray
    tangential_directions_of_position: FloatArray
    normal_motion: FloatArray
    tangential_motion: FloatArray
    normal_gap: FloatArray
    relative_velocity: FloatArray
    friction_coefficient: FloatArray
    static_friction_coefficient: FloatArray | None = None
    normal_force: FloatArray | None = None

    def __post_init__(self) -> None:
        checked_scalar("time_step", self.time_step, "> 0")
        freedoms, contacts = np.shape(self.velocity)[0], np.shape(self.normal_gap)[0]
        shapes: dict[str, tuple[int, ...]] = {
            "mass_matrix": (freedoms, freedoms),
            "force": (freedoms,),
            "velocity": (freedoms,),
            "normal_directions": (freedoms, contacts),
            "tangential_directions": (freedoms, contacts),
            "tangential_directions_of_position": (freedoms, contacts),
            "normal_motion": (contacts,),
            "tangential_motion": (contacts,),
            "normal_gap": (contacts,),
            "relative_velocity": (contacts,),
            "friction_coefficient": (contacts,),
        }
        for name, shape in shapes.items():
            checked_array(name, getattr(self, name), shape=shape)
        checked_array("friction_coefficient", self.friction_coefficient, ">= 0")
        if self.static_friction_coefficient is not None:
            static = checked_array("static_friction_coefficient", self.static_friction_coefficient, shape=(contacts,))
            if np.any(static < self.friction_coefficient):
                raise ParameterError(f"static_friction_coefficient = {static}; allowed: >= {self.friction_coefficient}")
        if self.normal_force is not None:
            checked_array("normal_force", self.normal_force, ">= 0", shape=(contacts,))

    @property
    def contacts(self) -> int:
        """Number of contacts c."""
        return self.normal_gap.shape[0]

    @property
    def response_to_normal(self) -> FloatArray:
        """M⁻¹ W_N, shape (f, c)."""
        return self._responses[:, : self.contacts]

    @property
    def response_to_tangential(self) -> FloatArray:
        """M⁻¹ W_T, shape (f, c)."""
        return self._responses[:, self.contacts : -1]

    @property
    def free_acceleration(self) -> FloatArray:
        """M⁻¹ h, the acceleration if no contact acted, shape (f,)."""
        return self._responses[:, -1]

    @cached_property
    def g_nn(self) -> FloatArray:
        """G_NN = W_Nᵀ M⁻¹ W_N, shape (c, c)."""
        return self.normal_directions.T @ self.response_to_normal

    @cached_property
    def g_nt(self) -> FloatArray:
        """G_NT = W_Nᵀ M⁻¹ W_T, shape (c, c)."""
        return self.normal_directions.T @ self.response_to_tangential

    @cached_property
    def g_tn(self) -> FloatArray:
        """G_TN = (W_Tᵀ + W̃_Tᵀ Δt) M⁻¹ W_N, shape (c, c)."""
        return self._tangential_map.T @ self.response_to_normal

    @cached_property
    def g_tt(self) -> FloatArray:
        """G_TT = (W_Tᵀ + W̃_Tᵀ Δt) M⁻¹ W_T, shape (c, c)."""
        return self._tangential_map.T @ self.response_to_tangential

    @cached_property
    def c_n(self) -> FloatArray:
        """C_N [m]: the normal gap at the end of the step if no contact acted, shape (c,)."""
        free = self.velocity + self.free_acceleration * self.time_step
        return self.normal_directions.T @ free * self.time_step + self.normal_motion * self.time_step + self.normal_gap

    @cached_property
    def c_t(self) -> FloatArray:
        """C_T [m/s]: the relative velocity at the end of the step if no contact acted, shape (c,)."""
        forced = self._tangential_map.T @ self.free_acceleration * self.time_step
        carried = self.tangential_directions_of_position.T @ self.velocity * self.time_step
        return forced + carried + self.tangential_motion * self.time_step + self.relative_velocity

    @property
    def _tangential_map(self) -> FloatArray:
        return self.tangential_directions + self.tangential_directions_of_position * self.time_step

    @cached_property
    def _responses(self) -> FloatArray:
        """M⁻¹ (W_N, W_T, h), shape (f, 2c + 1): the one solution of linear equations with M in a step."""
        columns = np.hstack([self.normal_directions, self.tangential_directions, self.force[:, None]])
        return np.asarray(np.linalg.solve(self.mass_matrix, columns))


@dataclass(frozen=True)
class ContactImpulses:
    """What the contacts do in one step.

    Parameters
    ----------
    normal
        Λ_N = λ_N Δt [N s], shape (c,).
    tangential
        Λ_T = λ_T Δt [N s], shape (c,), positive along W_T.
    normal_gap
        g_N at the end of the step [m]; ``None`` where the normal force was given.
    relative_velocity
        ġ_T at the end of the step [m/s].
    basic
        Which unknowns of the LCP are basic, shape (3c,), or (2c,) where the normal force was given; it
        warm-starts the next step.
    """

    normal: FloatArray
    tangential: FloatArray
    normal_gap: FloatArray | None
    relative_velocity: FloatArray
    basic: NDArray[np.bool_]


def assemble(step: FrictionalStep) -> tuple[FloatArray, FloatArray]:
    """Matrix and vector of equation (7), shapes (3c, 3c) and (3c,).

    Unknowns (Λ_N Δt, Λ_TR Δt, ġ_T⁻ Δt), complements (g_N, ġ_T⁺ Δt, Λ_TL Δt).
    """
    mu = np.diag(step.friction_coefficient)
    identity, zero = np.eye(step.contacts), np.zeros((step.contacts, step.contacts))
    matrix = np.block(
        [
            [step.g_nn - step.g_nt @ mu, step.g_nt, zero],
            [step.g_tn - step.g_tt @ mu, step.g_tt, identity],
            [2 * mu, -identity, zero],
        ]
    )
    return matrix, np.concatenate([step.c_n, step.c_t * step.time_step, np.zeros(step.contacts)])


def assemble_given_normal_force(step: FrictionalStep, normal: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Matrix and vector of the friction part of equation (7) when Λ_N is given, shapes (2c, 2c) and (2c,).

    (ġ_T⁺, Λ_TL) = [[G_TT, I], [−I, 0]] (Λ_TR, ġ_T⁻) + (C_T + (G_TN − G_TT μ) Λ_N, 2 μ Λ_N).

    `normal` is Λ_N [N s], shape (c,), >= 0. The directions W_N stay in the equation: what the
    given normal impulse does to the motion is part of the right-hand side.
    """
    checked_array("normal impulse", normal, ">= 0")
    identity, zero = np.eye(step.contacts), np.zeros((step.contacts, step.contacts))
    bound = step.friction_coefficient * normal
    matrix = np.block([[step.g_tt, identity], [-identity, zero]])
    return matrix, np.concatenate([step.c_t + step.g_tn @ normal - step.g_tt @ bound, 2 * bound])


def solve_step(step: FrictionalStep, *, warm_start: NDArray[np.bool_] | None = None) -> ContactImpulses:
    """Solve equation (7) by Lemke's method.

    Parameters
    ----------
    step
        The data of the step.
    warm_start
        `ContactImpulses.basic` of the step before: contacts that keep their modes need no pivot then.

    Raises
    ------
    StepFailed
        If none of the paths of Lemke's method ends with a solution.
    """
    dt, c = step.time_step, step.contacts
    result = _solved(lemke(*assemble(step), warm_start=warm_start, paths=PATHS))
    normal = result.z[:c] / dt
    tangential = result.z[c : 2 * c] / dt - step.friction_coefficient * normal
    slip = (result.w[c : 2 * c] - result.z[2 * c :]) / dt
    return ContactImpulses(normal, tangential, result.w[:c], slip, result.basic)


def solve_step_given_normal_force(
    step: FrictionalStep, normal: FloatArray, *, warm_start: NDArray[np.bool_] | None = None
) -> ContactImpulses:
    """Solve the friction part of equation (7) for a given Λ_N [N s], shape (c,), by Lemke's method.

    `warm_start` and what is raised are as in `solve_step`.
    """
    c = step.contacts
    result = _solved(lemke(*assemble_given_normal_force(step, normal), warm_start=warm_start, paths=PATHS))
    tangential = result.z[:c] - step.friction_coefficient * normal
    return ContactImpulses(normal, tangential, None, result.w[:c] - result.z[c:], result.basic)


def advanced(step: FrictionalStep, impulses: ContactImpulses, position: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Positions and velocities at the end of the step, equation (5): Δu = (q + Δq) Δt."""
    contact = step.response_to_normal @ impulses.normal + step.response_to_tangential @ impulses.tangential
    velocity = step.velocity + step.free_acceleration * step.time_step + contact
    return position + velocity * step.time_step, velocity


def _solved(result: LemkeResult) -> LemkeResult:
    if not result.solved:
        raise StepFailed(f"the LCP of the step is not solved: {result.status} after {result.pivots} pivots")
    return result
