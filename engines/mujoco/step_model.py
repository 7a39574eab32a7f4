"""The laws of MuJoCo's default friction: a constraint with a time constant, softened by a part of the inverse mass."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from multibody_xval.engines.interface.law import Constant, Law, NotModelled
from multibody_xval.engines.interface.presets import NormalForce, Preset
from multibody_xval.engines.mujoco.contact import DEPTH, LEAST_COEFFICIENT, TOUCH
from multibody_xval.engines.shared.kernel_lane import Kernel, KernelLane
from multibody_xval.engines.shared.units import power_of_two
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.schemes.linear_implicit import LinearImplicitLane, LinearStep, ScalarFriction
from reference_lcp.schemes.sequential import LaneModel
from reference_lcp.validation import FloatArray

LEAST_IMPEDANCE, LARGEST_IMPEDANCE, WIDTH = 0.9, 0.95, 0.001
"""d_0, d_max and width [m] of MuJoCo's `solimp`, for contacts and for frictionloss alike; no preset sets them."""

NEWTON_PERIOD = 3e-5
"""Of U0: MuJoCo's Newton stops where a step of it would lower its cost, over the inertia, by less than 1e-8 (m/s²)²
a degree of freedom. Up to √(2 · 14 · 1e-8) = 5e-4 m/s² are then left in that time step, which make 4e-6 U0 of a motion
with U0 ω² = 2 m/s², the gentlest that presets are held to; a period has a few such steps."""

NEWTON_REASON = "MuJoCo's Newton solver stops at a tolerance of 1e-8, now and then before all is solved"

RUBS_AND_PRESSES = (
    "the edges of its pyramid press and rub with one force: without softness it has no friction left to bound"
)
"""Of a sphere. A soft constraint that takes ever longer has none at all, and that limit is known too."""

HELD_FORMULA = (
    "as the joint's, with s = a_0 + A λ + b w, b = 2 / (τ d_max), R = 2 μ² (1 + μ²) (1 − d) / d (1/m_o + 2/m_i) / 3: "
    "λ = −2 μ² s / R while both edges press, μ |s| <= R λ_N / 4, and λ = −sgn(s) μ (R λ_N / 4 + μ |s|) / R beyond, "
    "without a bound; d from d_0 to d_max by the depth over the width δ; the normal force is λ_N/2 + max(λ_N/2, |λ|/μ)"
)
"""Of a sphere held at a fixed depth: each of the two edges along the slide lets go alone. In a row that is turned all
four edges are solved together, as those of a free sphere, with the load λ_N / 4 each instead of a depth."""

FREE_FORMULA = (
    "under a preload, with y the acceleration of the sphere on its plate in three directions and E the edges n ± μ t: "
    "0 <= f ⟂ E y + b E ẋ − k d z + R f >= 0 at the depth z > 0, f = 0 above the plate, y = y_0 + A Eᵀ f, "
    "b = 2 / (d_max max(τ, 2h)), k = 1 / (d_max max(τ, 2h))², R = 2 μ² (1 + μ²) (1 − d) / d (1/m_o + 3/m_i) / 3"
)
"""Of a sphere that is free across the row."""


VANISHING_STEP = 1e-12
"""What a time constant is at this step does not go with the step [s]."""


def joint_friction(preset: Preset) -> Law | NotModelled:
    """Give the law of a joint's frictionloss that has a time constant; one of two steps is the least there is."""
    constant = preset.value("solref_friction", VANISHING_STEP)[0]
    if constant <= 0:
        return NotModelled("its law is that of a time constant, and solref_friction has none")
    fixed = constant > 2 * VANISHING_STEP
    softness = preset.options.get("solimp_friction")
    least, largest = (LEAST_IMPEDANCE, LARGEST_IMPEDANCE) if softness is None else softness.value
    return Law(
        formula=(
            "forces at the start of the step: with a_0 = Wᵀ M⁻¹ (f(t) e_1 − C q̇ − K q), A = (Wᵀ M⁻¹ W)_ii, "
            "b = 2 / (d_max max(τ, 2h)): λ = clip(−(a_0 + b w) / (A + R), ±μ λ_N), R = A (1 − d_0) / d_0; "
            "dashpots of joints (c_i) then implicit, (M + h C_i) q̇⁺ = (M + h C_i − h C) q̇ − h K q + h f(t) e_1 + h W λ"
        ),
        constants={
            **({"τ": Constant(constant, "s", "solref_friction, time constant", ideal=0.0)} if fixed else {}),
            "d_0": Constant(least, "", "solimp_friction: where nothing is violated", ideal=1.0),
            "d_max": Constant(largest, "", "solimp_friction; solref is scaled by it", ideal=1.0),
        },
        model=_joint_friction,
        period_bound=NEWTON_PERIOD,
        bound_reason=NEWTON_REASON,
        modulated=True,
    )


def pyramidal_contact(preset: Preset) -> Law:
    """Give the law of a sphere with a pyramid of four edges: held at a fixed depth or, with a preload, free."""
    lifting = preset.represents(NormalForce.LIFTING)
    return Law(
        formula=FREE_FORMULA if preset.is_free else f"{HELD_FORMULA}; {FREE_FORMULA}" if lifting else HELD_FORMULA,
        constants={
            "τ": Constant(
                preset["normal time constant"], "s", "normal time constant; of a free sphere, solref", ideal=math.inf
            ),
            "d_0": Constant(LEAST_IMPEDANCE, "", "solimp, MuJoCo's own: of a contact that touches", ideal=0.0),
            "d_max": Constant(LARGEST_IMPEDANCE, "", "solimp, MuJoCo's own: of one deeper than the width", ideal=0.0),
            "δ": Constant(WIDTH, "m", "solimp, MuJoCo's own"),
        },
        model=lambda lane, of: _pyramidal_contact(preset.pressed(lane), of),
        without_friction=RUBS_AND_PRESSES,
        period_bound=NEWTON_PERIOD,
        bound_reason=NEWTON_REASON,
        modulated=lifting,
        lifting=lifting,
    )


def _joint_friction(lane: Lane, constants: Mapping[str, float]) -> LinearImplicitLane:
    step = _step(lane, damping_rate(constants.get("τ", 0.0), constants["d_max"], lane.time_step))
    softness = relative_softness(constants["d_0"]) * step.coupling.diagonal()
    return LinearImplicitLane(lane, step, ScalarFriction.coulomb(lane.chain.cells, softness))


def damping_rate(time_constant: float, largest: float, time_step: float) -> float:
    """Give b, by which a slip velocity decelerates itself [1/s]; `largest` is d_max."""
    return 2 / (largest * max(time_constant, 2 * time_step))


def relative_softness(least: float) -> float:
    """Give R / A of a joint's friction; `least` is d_0."""
    return (1 - least) / least


def _pyramidal_contact(lane: Lane, constants: Mapping[str, float]) -> LaneModel:
    time_constant = constants["τ"] if lane.preload is None else max(constants["τ"], 2 * lane.time_step)
    rate = 2 / (constants["d_max"] * time_constant)
    step = _step(lane, rate)
    if lane.preload is not None or lane.direction:
        return PyramidLane(lane, step, rate, constants)
    # MuJoCo takes the inverse mass of a body as a mean over three axes: an outer mass slides along one of them.
    inverse_mass = (1 / lane.chain.outer_mass + 2 / lane.chain.inner_mass) / 3
    return PyramidalContactLane(lane, step, inverse_mass, constants)


class PyramidalContactLane(LinearImplicitLane):
    """A step with friction of two edges, of which one lets go at half of the bound.

    A contact's softness is a part of `inverse_mass` [1/kg], shape (n,).
    """

    def __init__(self, lane: Lane, step: LinearStep, inverse_mass: FloatArray, constants: Mapping[str, float]):
        chain = lane.chain
        depth = DEPTH * power_of_two(lane.drive.displacement_scale(chain))
        d = float(impedance(depth, constants["d_0"], constants["d_max"], constants["δ"]))
        self._coefficient = np.maximum(chain.friction_coefficient, LEAST_COEFFICIENT)
        compliance = (1 + self._coefficient**2) * (1 - d) / d * inverse_mass
        friction = ScalarFriction.coulomb(chain.cells, compliance, 1 / (2 * compliance), bound_share=0.5)
        super().__init__(lane, step, friction)

    def normal_force(self, friction: FloatArray, preload: FloatArray) -> FloatArray:
        """Give the sum over the edges: two across the slide keep their half, those along it carry the friction."""
        return preload / 2 + np.maximum(preload / 2, np.abs(friction) / self._coefficient)


def _step(lane: Lane, rate: float) -> LinearStep:
    """Give MuJoCo's step: friction knows no dashpot of a joint at the end of the step, the masses do."""
    chain, h = lane.chain, lane.time_step
    mass, damping, directions = chain.mass_matrix, chain.damping_matrix, chain.contact_directions
    matrix = mass + h * (directions @ np.diag(chain.inner_damping) @ directions.T)
    seen = LinearStep.of(chain, h, mass, mass - h * damping, (1.0, 0.0), slip_weight=h * rate - 1)
    return LinearStep.of(chain, h, matrix, matrix - h * damping, (1.0, 0.0)).with_friction_of(seen)


class PyramidLane(KernelLane):
    """One chain of spheres on plates, whose edges may let friction press and lift.

    A lane with a preload has spheres that are free across the row, and a state with their gaps; others are held.
    """

    columns = 7

    def __init__(self, lane: Lane, step: LinearStep, rate: float, constants: Mapping[str, float]):
        chain, free = lane.chain, lane.preload is not None
        super().__init__(lane)
        self._free = free
        size = 2 * chain.cells
        self._matrices = (step.state.copy(), step.load[:, 0].copy(), step.response[:size].copy())
        depth = (TOUCH if free else DEPTH) * power_of_two(lane.drive.displacement_scale(chain))
        touching = np.full(chain.cells, depth) if free else np.where(chain.friction_bound > 0, depth, 0.0)
        self._numbers = (lane.time_step, rate, touching)
        solimp = (constants["d_0"], constants["d_max"], constants["δ"])
        # the critical damping of MuJoCo's default; where spheres are held, what they press with takes its place
        constraint = (lane.time_step * rate**2 / 4 if free else 0.0, *solimp)
        self._contacts = (_masses(lane), _edges(lane), constraint)

    def _integrate(self, state: State, start: int, steps: int, record: FloatArray) -> State:
        """Run the kernel; what moves across the row in the plane of contacts begins at rest, as in MuJoCo."""
        lane, cells = self.lane, self.lane.chain.cells
        motion = np.vstack([state.positions[0], state.velocities[0]])
        aside = np.zeros((cells, 3))
        if self._free:
            aside[:, 1:] = np.vstack([part[0] for part in state.normal_state(cells)]).T
        loads, presses = lane.loads(start, steps), np.ascontiguousarray(lane.preloads(start, steps))
        advance(motion, aside, loads, presses, self._matrices, self._numbers, self._contacts, record)
        if not self._free:
            return State(motion[:1], motion[1:])
        return State(motion[:1], motion[1:], aside[:, 1:].T.reshape(1, -1))


def _edges(lane: Lane) -> FloatArray:
    """Give the edges n ± μ t of every contact, shape (n, 4, 3): along the row, across it in its plane, out of that.

    Tangents have the directions of the world, whatever that of the row.
    """
    along, aside = lane.axis
    tangents = np.array([[along, -aside, 0.0], [aside, along, 0.0]])
    coefficient = np.maximum(lane.chain.friction_coefficient, LEAST_COEFFICIENT)
    return np.array([0.0, 0.0, 1.0]) + coefficient[:, None, None] * np.vstack([tangents, -tangents])


def _masses(lane: Lane) -> FloatArray:
    """Give the inverse masses of every contact in its three directions, and R d / (1 − d) of its edges; shape (n, 4).

    MuJoCo takes the inverse mass of a body as a mean over three axes: an outer mass slides along one of them, an inner
    one along two or, where it is free, three.
    """
    chain = lane.chain
    outer, inner = 1 / chain.outer_mass, 1 / chain.inner_mass
    above = inner if lane.preload is not None else np.zeros(chain.cells)
    coefficient = np.maximum(chain.friction_coefficient, LEAST_COEFFICIENT)
    softness = 2 * coefficient**2 * (1 + coefficient**2) * (outer + 2 * inner + above) / 3
    return np.column_stack([outer + inner, inner, above, softness])


MOST_CORRECTIONS = 20
"""Sets of pressing edges that Newton's iteration tries; it needs two or three, and may cycle."""


IMPULSE, AIM, PRESSING, SOLUTION, COUPLING = range(5)
"""Rows of the array that a contact of n edges is solved in, shape (4 + 2n, n): n of the last, and as many to eliminate.

It is one array, since numba counts references to every further one, which takes longer than the elimination.
"""


@Kernel
def _solve(work: Any) -> None:
    """Write p of the edges that press, (E A Eᵀ + R) p = −(E y_free + o), and (E A Eᵀ) p + E y_free + o of the others.

    By elimination without pivoting, since E A Eᵀ + R is positive definite; LAPACK takes seconds to be compiled for.
    """
    count = work.shape[1]
    matrix = COUPLING + count
    for i in range(count):
        work[SOLUTION, i] = work[AIM, i]
        for j in range(count):
            work[matrix + i, j] = work[COUPLING + i, j]
    for k in range(count):
        if not work[PRESSING, k]:
            continue
        for i in range(count):
            if i != k:
                factor = work[matrix + i, k] / work[matrix + k, k]
                for j in range(count):
                    work[matrix + i, j] -= factor * work[matrix + k, j]
                work[SOLUTION, i] -= factor * work[SOLUTION, k]
    for k in range(count):
        if work[PRESSING, k]:
            work[SOLUTION, k] /= -work[matrix + k, k]


@Kernel
def _settled(work: Any) -> Any:
    """Let go of edges that would pull, and press those that would pass: whether there were none, changed in place."""
    settled = True
    for i in range(work.shape[1]):
        if work[SOLUTION, i] < 0:
            work[PRESSING, i], settled = 0.0 if work[PRESSING, i] else 1.0, False
    return settled


@Kernel
def write_edge_impulses(free: Any, inverse_mass: Any, edges: Any, softness: Any, offset: Any, work: Any) -> None:
    """Write p >= 0 of every edge with E y + o + R p >= 0, one or the other zero, and y = y_free + A Eᵀ p.

    Newton's iteration over the sets of edges that press; where it cycles, all sets are tried.
    """
    count = edges.shape[0]
    for i in range(count):
        work[IMPULSE, i], work[AIM, i], work[PRESSING, i] = 0.0, offset, 1.0
        for k in range(3):
            work[AIM, i] += edges[i, k] * free[k]
        for j in range(count):
            total = softness if i == j else 0.0
            for k in range(3):
                total += edges[i, k] * inverse_mass[k] * edges[j, k]
            work[COUPLING + i, j] = total
    for _ in range(MOST_CORRECTIONS):
        _solve(work)
        if _settled(work):
            _press(work)
            return
    least = np.inf
    for number in range(2**count):
        for edge in range(count):
            work[PRESSING, edge] = (number >> edge) & 1
        _solve(work)
        worst = 0.0
        for edge in range(count):
            worst = max(worst, -work[SOLUTION, edge])
        if worst < least:
            _press(work)
            least = worst


@Kernel
def _press(work: Any) -> None:
    """Write the impulses of the edges that press, none of which pulls."""
    for i in range(work.shape[1]):
        work[IMPULSE, i] = max(work[SOLUTION, i], 0.0) if work[PRESSING, i] else 0.0


@Kernel
def impedance(depth: Any, least: Any, largest: Any, width: Any) -> Any:
    """Give d at a depth [m]: `solimp` with its midpoint 0.5 and its power 2, MuJoCo's own."""
    part = min(1.0, depth / width)
    rise = 2 * part**2 if part <= 0.5 else 1 - 2 * (1 - part) ** 2
    return least + (largest - least) * rise


@Kernel
def _write_impulses(free: Any, press: Any, depth: Any, contact: Any, edges: Any, constraint: Any, work: Any) -> None:
    """Write the impulses of the edges of one contact.

    `free` is h (a_0 + b w) in the three directions, where no edge presses; `press` what presses a contact that is held,
    times h; `depth` [m] that at the start of the step; `contact` the inverse masses in the three directions, and what
    the softness of edges is in proportion to; `constraint` h k, zero where the depth is held, d_0, d_max and δ.
    """
    stiffness, least, largest, width = constraint
    if depth <= 0:
        for edge in range(edges.shape[0]):
            work[IMPULSE, edge] = 0.0
        return
    part = impedance(depth, least, largest, width)
    softness = contact[3] * (1 - part) / part
    # what each edge aims at: to get out of the plate, or to press with its share
    offset = -stiffness * part * depth if stiffness > 0 else -softness * press / edges.shape[0]
    write_edge_impulses(free, contact, edges, softness, offset, work)


@Kernel
def _dot(a: Any, b: Any) -> Any:
    """Give the scalar product; written out, since BLAS takes seconds to be compiled for."""
    total = 0.0
    for i in range(a.size):
        total += a[i] * b[i]
    return total


@Kernel
def _total(work: Any, edges: Any, direction: int) -> Any:
    """Add up the impulses of all edges in a direction."""
    total = 0.0
    for edge in range(edges.shape[0]):
        total += work[IMPULSE, edge] * edges[edge, direction]
    return total


@Kernel
def advance(
    motion: Any, aside: Any, loads: Any, presses: Any, matrices: Any, numbers: Any, contacts: Any, record: Any
) -> None:
    """Advance one lane in place; see `PyramidLane`.

    `motion`, shape (2, 2n), are positions and velocities along the row; `aside`, shape (n, 3), of every cell the
    velocity across the row in the plane of its contacts, the height, and its rate; `loads`, shape (steps,), the force
    on cell 1, and `presses`, shape (steps, n), what presses contacts. `matrices` are those of the linear step;
    `numbers` h, b and the depths at no gap; `contacts` inverse masses and softness, edges, and numbers of the
    constraint. `record`, shape (steps, 7n), gets positions, velocities, friction, normal
    force and gap of each step; it may have no rows.
    """
    state_matrix, load, response = matrices
    length, rate, touch = numbers
    contact, edges, constraint = contacts
    cells, size = contact.shape[0], motion.shape[1]
    state, seen = np.empty(2 * size), np.empty(size + cells)
    for i in range(size):
        state[i], state[size + i] = motion[1, i], motion[0, i]
    free, impulse, pressed, held = np.empty(3), np.empty(3), np.empty(3), constraint[0] == 0
    count = edges.shape[1]
    work = np.empty((COUPLING + 2 * count, count))
    for step in range(loads.size):
        for i in range(size + cells):
            seen[i] = load[i] * loads[step] + _dot(state_matrix[i], state)
        for i in range(cells):
            free[0], free[1], free[2] = seen[size + i], length * rate * aside[i, 0], length * rate * aside[i, 2]
            for k in range(3):
                impulse[k] = 0.0 if held or k < 2 else -length * presses[step, i]
                free[k] += contact[i, k] * impulse[k]
            press, depth = length * presses[step, i], touch[i] - aside[i, 1]
            _write_impulses(free, press, depth, contact[i], edges[i], constraint, work)
            for k in range(3):
                pressed[k] = _total(work, edges[i], k)
                impulse[k] += pressed[k]
            if record.shape[0] > 0:
                record[step, 2 * size + i] = pressed[0] / length
                record[step, 2 * size + cells + i] = _dot(work[IMPULSE], np.ones(count)) / length
            aside[i, 0] += contact[i, 1] * impulse[1]
            aside[i, 2] += contact[i, 2] * impulse[2]
            aside[i, 1] += length * aside[i, 2]
            for k in range(size):
                seen[k] += response[k, i] * impulse[0]
        for i in range(size):
            state[i] = seen[i]
            state[size + i] += length * state[i]
        if record.shape[0] > 0:
            _keep(state, aside, record[step])
    for i in range(size):
        motion[0, i], motion[1, i] = state[size + i], state[i]


@Kernel
def _keep(state: Any, aside: Any, row: Any) -> None:
    """Write positions, velocities and gaps of a step."""
    cells = aside.shape[0]
    size = 2 * cells
    for i in range(size):
        row[i], row[size + i] = state[size + i], state[i]
    for i in range(cells):
        row[2 * size + 2 * cells + i] = aside[i, 1]
