"""Equation (7): one time step of a frictional system as a linear complementarity problem.

The equations follow from (3), (5) and (6) of the paper; where its print has lost marks, this module
follows the derivation:

- g_T of (6b) is the relative *velocity* at the start of the step, and h is evaluated there too;
- the unknowns are (Λ_N Δt, Λ_TR Δt, ġ_T⁻ Δt), their complements (g_N, ġ_T⁺ Δt, Λ_TL Δt) at the
  end of the step: the print gives both parts of the relative velocity the same symbol;
- C_T = (W_Tᵀ + W̃_Tᵀ Δt) M⁻¹ h Δt + W̃_Tᵀ q Δt + ω̃_T Δt + g_T: the print has an undefined
  G_T h Δt, and W_Tᵀ q Δt without the tilde.

Friction at rest may be larger than in motion. With μ_s > μ_k the law of a contact is

    |λ_T| <= μ_s λ_N where ġ_T = 0,        λ_T = −μ_k λ_N sign ġ_T elsewhere,

and a step is a sequence of LCPs, each equation (7) with one coefficient a contact:

1. contacts at rest at the start of the step have μ_s, all others μ_k;
2. a contact with μ_s that slips in the solution is released: it has μ_k from then on. One with μ_k whose relative
   velocity has changed its sign passed rest within the step, and has μ_s. The LCP is solved anew.

Each contact changes at most twice, so that at most 2c + 1 LCPs are solved. Where μ_s > μ_k other sets of sliding
contacts may fulfil the law too; of these the rule above chooses: rest before slip, and all that break away in one LCP
are released together.
"""

import dataclasses
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference_lcp.errors import ParameterError
from reference_lcp.lcp.lemke import LemkeResult, lemke
from reference_lcp.validation import FloatArray, checked_array, checked_scalar

REST_TOLERANCE = 1e-12
"""Relative velocity over the largest velocity of the step at which a contact is at rest: roundings of its solution."""


class StepFailed(RuntimeError):
    """The complementarity problem of a step has not been solved; the message has the status of Lemke's path."""


@dataclass(frozen=True, kw_only=True)
class FrictionalStep:
    """Everything that equation (7) takes from the start of one step of a system with c contacts."""

    mass_matrix: FloatArray
    """M, shape (f, f), symmetric positive definite."""
    force: FloatArray
    """h, all forces but those of the contacts [N], shape (f,), at the start of the step."""
    velocity: FloatArray
    """q = u̇ at the start of the step, shape (f,)."""
    time_step: float
    """Δt [s]."""
    normal_directions: FloatArray
    """W_N, shape (f, c)."""
    tangential_directions: FloatArray
    """W_T, shape (f, c)."""
    normal_gap: FloatArray
    """g_N at the start of the step [m], shape (c,)."""
    relative_velocity: FloatArray
    """ġ_T at the start of the step [m/s], shape (c,), the velocity of moving surfaces included."""
    friction_coefficient: FloatArray
    """μ, shape (c,); of contacts in motion, where friction at rest is another."""
    tangential_directions_of_position: FloatArray = dataclasses.field(default_factory=lambda: np.zeros(()))
    """W̃_T = (∂ġ_T/∂u)ᵀ [1/s], shape (f, c)."""
    normal_motion: FloatArray = dataclasses.field(default_factory=lambda: np.zeros(()))
    """ω̃_N = ∂g_N/∂t [m/s], shape (c,): a surface that moves along the normal."""
    tangential_motion: FloatArray = dataclasses.field(default_factory=lambda: np.zeros(()))
    """ω̃_T = ∂ġ_T/∂t [m/s²], shape (c,): a surface whose tangential velocity changes."""
    static_friction_coefficient: FloatArray | None = None
    """μ_s >= μ of contacts at rest, shape (c,), see `reference_lcp.lcp.time_step`; ``None`` where it is μ."""
    normal_force: FloatArray | None = None
    """λ_N [N] >= 0 where it is given, shape (c,); ``None`` where the step resolves it."""

    @classmethod
    def under_normal_force(cls, directions: FloatArray, velocity: FloatArray, **given: Any) -> "FrictionalStep":
        """Give the step of contacts whose given normal force has no part along the motion, so that W_N is zero."""
        return cls(
            velocity=velocity,
            normal_directions=np.zeros(directions.shape),
            tangential_directions=directions,
            normal_gap=np.zeros(directions.shape[1]),
            relative_velocity=directions.T @ velocity,
            **given,
        )

    def __post_init__(self) -> None:
        vectors = ("normal_motion", "tangential_motion")
        for name in (*vectors, "tangential_directions_of_position"):
            if np.ndim(getattr(self, name)) == 0:
                like = self.normal_gap if name in vectors else self.tangential_directions
                object.__setattr__(self, name, np.full(np.shape(like), getattr(self, name)))
        checked_scalar("time_step", self.time_step, "> 0")
        sizes, contacts = {"f": np.shape(self.velocity)[0], "c": self.contacts}, (self.contacts,)
        for name, axes in _SHAPES.items():
            checked_array(name, getattr(self, name), shape=tuple(sizes[axis] for axis in axes))
        checked_array("friction_coefficient", self.friction_coefficient, ">= 0", shape=contacts)
        if self.static_friction_coefficient is not None:
            static = checked_array("static_friction_coefficient", self.static_friction_coefficient, shape=contacts)
            if np.any(static < self.friction_coefficient):
                raise ParameterError(f"static_friction_coefficient = {static}; allowed: >= {self.friction_coefficient}")
        if self.normal_force is not None:
            checked_array("normal_force", self.normal_force, ">= 0", shape=contacts)

    @property
    def contacts(self) -> int:
        """Number of contacts c."""
        return self.normal_gap.shape[0]

    @cached_property
    def responses(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """M⁻¹ W_N and M⁻¹ W_T, shape (f, c), and M⁻¹ h, the acceleration if no contact acted, shape (f,)."""
        columns = np.hstack([self.normal_directions, self.tangential_directions, self.force[:, None]])
        solved = np.asarray(np.linalg.solve(self.mass_matrix, columns))
        return solved[:, : self.contacts], solved[:, self.contacts : -1], solved[:, -1]


_SHAPES = {
    "mass_matrix": "ff", "force": "f", "velocity": "f", "normal_directions": "fc", "tangential_directions": "fc",
    "normal_gap": "c", "relative_velocity": "c", "tangential_directions_of_position": "fc", "normal_motion": "c",
    "tangential_motion": "c",
}  # fmt: skip
"""Freedoms f and contacts c along the axes of each field."""


@dataclass(frozen=True)
class ContactImpulses:
    """What the contacts do in one step."""

    normal: FloatArray
    """Λ_N = λ_N Δt [N s], shape (c,)."""
    tangential: FloatArray
    """Λ_T = λ_T Δt [N s], shape (c,), positive along W_T."""
    normal_gap: FloatArray | None
    """g_N at the end of the step [m]; ``None`` where the normal force was given."""
    relative_velocity: FloatArray
    """ġ_T at the end of the step [m/s]."""
    basic: NDArray[np.bool_]
    """Which unknowns of the LCP are basic, shape (3c,), or (2c,) where the normal force was given, for a warm start."""


def assemble(step: FrictionalStep) -> tuple[FloatArray, FloatArray]:
    """Matrix and vector of equation (7), shapes (3c, 3c) and (3c,), or of its friction part where Λ_N is given.

    Unknowns (Λ_N Δt, Λ_TR Δt, ġ_T⁻ Δt), complements (g_N, ġ_T⁺ Δt, Λ_TL Δt):

        ⎡ G_NN − G_NT μ   G_NT   0 ⎤   ⎡ C_N    ⎤
        ⎢ G_TN − G_TT μ   G_TT   I ⎥ , ⎢ C_T Δt ⎥ .
        ⎣ 2 μ             −I     0 ⎦   ⎣ 0      ⎦

    with G_NN = W_Nᵀ M⁻¹ W_N and G_NT = W_Nᵀ M⁻¹ W_T, and G_TN and G_TT with W_Tᵀ + W̃_Tᵀ Δt on the left. A given Λ_N
    moves to the right-hand side; what it does to the motion, by the directions W_N, stays in the equation:

        (ġ_T⁺, Λ_TL) = [[G_TT, I], [−I, 0]] (Λ_TR, ġ_T⁻) + (C_T + (G_TN − G_TT μ) Λ_N, 2 μ Λ_N).
    """
    dt, (to_normal, to_tangential, free) = step.time_step, step.responses
    tangential = step.tangential_directions + step.tangential_directions_of_position * dt
    g_tn, g_tt = tangential.T @ to_normal, tangential.T @ to_tangential
    carried = step.tangential_directions_of_position.T @ step.velocity * dt
    c_t = tangential.T @ free * dt + carried + step.tangential_motion * dt + step.relative_velocity
    identity, zero = np.eye(step.contacts), np.zeros((step.contacts, step.contacts))
    if step.normal_force is not None:
        normal = step.normal_force * dt
        bound = step.friction_coefficient * normal
        matrix = _square([[g_tt, identity], [-identity, zero]])
        return matrix, np.concatenate([c_t + g_tn @ normal - g_tt @ bound, 2 * bound])
    g_nn, g_nt = step.normal_directions.T @ to_normal, step.normal_directions.T @ to_tangential
    c_n = step.normal_directions.T @ (step.velocity + free * dt) * dt + step.normal_motion * dt + step.normal_gap
    mu = np.diag(step.friction_coefficient)
    matrix = _square([[g_nn - g_nt @ mu, g_nt, zero], [g_tn - g_tt @ mu, g_tt, identity], [2 * mu, -identity, zero]])
    return matrix, np.concatenate([c_n, c_t * dt, np.zeros(step.contacts)])


def _square(rows: Sequence[Sequence[FloatArray]]) -> FloatArray:
    """Put square blocks together, as np.block does, in a fraction of its time."""
    return np.concatenate([np.concatenate(row, axis=1) for row in rows])


def solve_step(step: FrictionalStep, *, warm_start: NDArray[np.bool_] | None = None) -> ContactImpulses:
    """Solve equation (7) by Lemke's method, with μ_s of contacts at rest by the rule of this module."""
    if step.contacts == 0:
        none = np.zeros(0)
        return ContactImpulses(none, none, none, none, np.zeros(0, dtype=bool))
    static, kinetic = step.static_friction_coefficient, step.friction_coefficient
    if static is None or np.array_equal(static, kinetic):
        return _impulses(step, lemke(*assemble(step), warm_start=warm_start))
    gained = step.responses[2] * step.time_step
    fastest = float(np.max(np.abs(step.velocity), initial=0.0) + np.max(np.abs(gained), initial=0.0))
    rest = REST_TOLERANCE * fastest
    before = np.where(np.abs(step.relative_velocity) > rest, np.sign(step.relative_velocity), 0.0)
    holds, released = before == 0, np.zeros(step.contacts, dtype=bool)
    while True:
        tried = dataclasses.replace(step, friction_coefficient=np.where(holds, static, kinetic))
        impulses = _impulses(tried, lemke(*assemble(tried), warm_start=warm_start))
        slips = np.abs(impulses.relative_velocity) > rest
        breaks = holds & slips
        turns = ~holds & ~released & slips & (impulses.relative_velocity * before < 0)
        if not np.any(breaks | turns):
            return impulses
        holds, released, warm_start = (holds | turns) & ~breaks, released | breaks, impulses.basic


def _impulses(step: FrictionalStep, result: LemkeResult) -> ContactImpulses:
    if not result.solved:
        raise StepFailed(f"the LCP of the step is not solved: {result.status} after {result.pivots} pivots")
    dt, c, z, w = step.time_step, step.contacts, result.z, result.w
    if step.normal_force is not None:
        normal = step.normal_force * dt
        return ContactImpulses(normal, z[:c] - step.friction_coefficient * normal, None, w[:c] - z[c:], result.basic)
    normal = z[:c] / dt
    tangential = z[c : 2 * c] / dt - step.friction_coefficient * normal
    return ContactImpulses(normal, tangential, w[:c], (w[c : 2 * c] - z[2 * c :]) / dt, result.basic)


def advanced(step: FrictionalStep, impulses: ContactImpulses, position: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Positions and velocities at the end of the step, equation (5): Δu = (q + Δq) Δt."""
    to_normal, to_tangential, free = step.responses
    contact = to_normal @ impulses.normal + to_tangential @ impulses.tangential
    velocity = step.velocity + free * step.time_step + contact
    return position + velocity * step.time_step, velocity


def solved_steps(
    step_from: Callable[[int, FloatArray, FloatArray], FrictionalStep],
    indices: Iterable[int],
    position: FloatArray,
    velocity: FloatArray,
) -> Iterator[tuple[FloatArray, FloatArray, ContactImpulses]]:
    """Solve steps, each from where the one before has ended: positions, velocities and impulses of every one."""
    basis = None
    for index in indices:
        step = step_from(index, position, velocity)
        try:
            impulses = solve_step(step, warm_start=basis)
        except StepFailed as failure:
            raise StepFailed(f"step {index} at t = {index * step.time_step:.6g} s: {failure}") from failure
        position, velocity = advanced(step, impulses, position)
        basis = impulses.basic
        yield position, velocity, impulses
