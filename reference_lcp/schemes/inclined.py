"""Chains with inclined contacts: equation (7) in full, by Lemke's method in every step, compiled, contact by contact.

The inner mass of cell i moves in the plane: v_i along the row, y_i across it. The outer mass, guided
along the row, carries a flat face inclined by α to the row, with tangent t = (cos α, sin α) and normal
n = (−sin α, cos α). With (v_i − u_i, y_i) the place of the inner mass relative to the outer one,

    g_N = −sin α (v_i − u_i) + cos α y_i        ġ_T = cos α (v̇_i − u̇_i) + sin α ẏ_i.

An actuator between the two masses of the cell presses the inner mass against the face, along n, with

    N_i(t) = N0_i (1 + a_i sin(Ω t + φ)),

N0_i being the chain's `normal_force`; where a_i > 1 it pulls the inner mass off the face for a part of
each cycle. Springs, dashpots and the drive are the chain's and act along the row. So equation (4) reads

    M ü = f − K u − C u̇ − W_N N(t) + W_N λ_N + W_T λ_T,     M = diag(m_o, m_i, m_i).

The spring k_i now loads and unloads the contact, and G_NT = W_Nᵀ M⁻¹ W_T = −sin α cos α / m_o couples normal and
tangential direction. A contact touches the two masses of its own cell alone, and M is diagonal: equation (7) splits
into an LCP of three unknowns for each contact, (Λ_N Δt, Λ_TR Δt, ġ_T⁻ Δt), with a matrix that no step changes.
"""

import math
from typing import Any

import numba
import numpy as np

from reference_lcp.chain.preload import Preload
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.lcp.lemke import STATUSES
from reference_lcp.lcp.pivoting import SOLVED, solve_scaled_lcp
from reference_lcp.lcp.scaling import power_of_two_scaling
from reference_lcp.lcp.time_step import PATHS, FrictionalStep, StepFailed, assemble
from reference_lcp.schemes.sequential import LaneModel
from reference_lcp.validation import FloatArray

UNKNOWNS = 3
"""Of the LCP of a contact."""

FIELDS = 8
"""Numbers of a contact in a row of the record: u, v, y, their velocities, λ_T and λ_N."""

CONSTANT = Preload(modulation=0.0, angular_frequency=1.0)
"""A preload that does not change."""


@numba.njit(cache=True, nogil=True, error_model="numpy")
def advance_inclined(
    x: Any, springs: Any, masses: Any, matrices: Any, scales: Any, angle: Any, time_step: float, loads: Any,
    preloads: Any, paths: int, record: Any,
) -> Any:  # fmt: skip
    """Advance one lane in place, and write each step's end; gives how many steps were solved, and Lemke's last status.

    The state `x`, shape (6, n), holds u, v, y and their velocities; `springs` (4, n) chain stiffness and damping, inner
    stiffness and damping; `masses` (2, n) m_o and m_i; `matrices` (n, 3, 3) those of the LCP of each contact, and
    `scales` (n, 2, 3) their `power_of_two_scaling`; `angle` (3, n) μ, sin α and cos α. `loads` (steps,) and `preloads`
    (steps, n) act at the start of each step; `record` is (steps, 8, n), see `FIELDS`.
    """
    cells = x.shape[1]
    basic, warm = np.zeros((cells, UNKNOWNS), dtype=np.bool_), False
    # The covering vector and the limit are those of `lemke`, and so are their types: it is compiled once for both.
    covering, limit = np.zeros(0), 50 * UNKNOWNS + 100
    for step in range(loads.size):
        pull = _pull(x, springs, 0, 0.0, 0.0) - loads[step]
        for i in range(cells):
            ahead = 0.0 if i + 1 == cells else _pull(x, springs, i + 1, x[0, i], x[3, i])
            free = _free_velocities(x, springs, masses, i, ahead - pull, angle, preloads[step, i], time_step)
            pull = ahead
            q = _vector(x, free, angle, i, time_step)
            start = basic[i] if warm else basic[i, :0]
            z, _, _, code, _, basis = solve_scaled_lcp(
                matrices[i], q, scales[i, 0], scales[i, 1], covering, limit, start, paths
            )
            if code != SOLVED:
                return step, code
            for k in range(UNKNOWNS):
                basic[i, k] = basis[k]
            _end_step(x, free, masses, angle, i, z, time_step, record[step])
        warm = True
    return loads.size, SOLVED


@numba.njit(inline="always", nogil=True, error_model="numpy")
def _pull(x: Any, springs: Any, cell: int, before: float, rate_before: float) -> float:
    """Force of the chain element at the left of a cell, whose other end is at `before`."""
    return springs[0, cell] * (x[0, cell] - before) + springs[1, cell] * (x[3, cell] - rate_before)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _free_velocities(
    x: Any, springs: Any, masses: Any, i: int, along: float, angle: Any, normal: float, time_step: float
) -> Any:
    """Velocities of u, v and y at the end of the step if no contact acted; `along` is the chain's force on u."""
    inner = springs[2, i] * (x[1, i] - x[0, i]) + springs[3, i] * (x[4, i] - x[3, i])
    sine, cosine = angle[1, i], angle[2, i]
    outer = x[3, i] + time_step * (along + inner - sine * normal) / masses[0, i]
    row = x[4, i] + time_step * (sine * normal - inner) / masses[1, i]
    return outer, row, x[5, i] - time_step * cosine * normal / masses[1, i]


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _vector(x: Any, free: Any, angle: Any, i: int, time_step: float) -> Any:
    """The vector (C_N, C_T Δt, 0) of the LCP of a contact."""
    sine, cosine = angle[1, i], angle[2, i]
    gap = cosine * x[2, i] - sine * (x[1, i] - x[0, i])
    parting = cosine * free[2] - sine * (free[1] - free[0])
    slip = cosine * (free[1] - free[0]) + sine * free[2]
    return np.array([gap + time_step * parting, time_step * slip, 0.0])


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _end_step(x: Any, free: Any, masses: Any, angle: Any, i: int, z: Any, time_step: float, row: Any) -> None:
    """Let the contact act, move the masses, and write the cell's numbers into its row."""
    mu, sine, cosine = angle[0, i], angle[1, i], angle[2, i]
    normal = z[0] / time_step
    tangential = z[1] / time_step - mu * normal
    along, across = cosine * tangential - sine * normal, sine * tangential + cosine * normal
    velocities = (free[0] - along / masses[0, i], free[1] + along / masses[1, i], free[2] + across / masses[1, i])
    for k in range(UNKNOWNS):
        x[UNKNOWNS + k, i] = velocities[k]
        x[k, i] += time_step * velocities[k]
    for k in range(2 * UNKNOWNS):
        row[k, i] = x[k, i]
    row[2 * UNKNOWNS, i], row[2 * UNKNOWNS + 1, i] = tangential / time_step, normal / time_step


class InclinedLane(LaneModel):
    """One chain whose normal forces depend on its motion; `State.normal_state` holds its gaps along the normals."""

    def __init__(self, lane: Lane):
        chain = lane.chain
        self.lane = lane
        self._sine, self._cosine = math.sin(lane.inclination), math.cos(lane.inclination)
        self._springs = np.array(
            [chain.chain_stiffness, chain.chain_damping, chain.inner_stiffness, chain.inner_damping]
        )
        self._masses = np.array([chain.outer_mass, chain.inner_mass])
        self._angle = np.array([[mu, self._sine, self._cosine] for mu in chain.friction_coefficient]).T.copy()
        self._matrices = _contact_matrices(lane)
        self._scales = np.array([power_of_two_scaling(matrix) for matrix in self._matrices])

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state`; see `LaneModel.run`."""
        n = self.lane.chain.cells
        gap, speed = state.normal_state(n)
        x = np.vstack(list(map(self._with_heights, (state.positions[0], state.velocities[0]), (gap[0], speed[0]))))
        record = np.empty((steps, FIELDS, n))
        solved, status = advance_inclined(
            x, self._springs, self._masses, self._matrices, self._scales, self._angle, self.lane.time_step,
            self.lane.loads(start, steps), np.ascontiguousarray(self.lane.preloads(start, steps)), PATHS, record,
        )  # fmt: skip
        if status != SOLVED:
            index = start + solved
            raise StepFailed(
                f"step {index} at t = {index * self.lane.time_step:.6g} s: the LCP of a contact is not solved: "
                f"{STATUSES[status]}"
            )
        gaps, speeds = self._normal(record[:, :3]), self._normal(record[-1:, 3:6])
        return Trajectory(
            time=self.lane.times(start, steps),
            positions=record[:, 0:2].reshape(steps, -1),
            velocities=record[:, 3:5].reshape(steps, -1),
            friction=record[:, 6].copy(),
            normal_force=record[:, 7].copy(),
            internal_state=np.concatenate([gaps[-1], speeds[-1]]),
            normal_gap=gaps,
        )

    def _with_heights(self, absolute: FloatArray, gap: FloatArray) -> FloatArray:
        """Give (u, v, y), shape (3, n), y being the coordinates at which the gaps are these; velocities likewise."""
        outer, inner = np.split(absolute, 2)
        return np.array([outer, inner, (gap + self._sine * (inner - outer)) / self._cosine])

    def _normal(self, coordinates: FloatArray) -> FloatArray:
        """Gaps from (u, v, y), shape (steps, 3, n); their rates from velocities."""
        outer, inner, across = coordinates.swapaxes(0, 1)
        return self._cosine * across - self._sine * (inner - outer)


def _contact_matrices(lane: Lane) -> FloatArray:
    """Matrices of the LCPs of the contacts, shape (n, 3, 3), from that of equation (7), where no others are coupled."""
    n = lane.chain.cells
    chain, still, motion = lane.chain, np.zeros(n), np.zeros(3 * n)
    sine, cosine, identity = math.sin(lane.inclination), math.cos(lane.inclination), np.eye(n)
    step = FrictionalStep(
        mass_matrix=np.diag(np.concatenate([chain.outer_mass, chain.inner_mass, chain.inner_mass])),
        force=motion,
        velocity=motion,
        time_step=lane.time_step,
        normal_directions=np.vstack([sine * identity, -sine * identity, cosine * identity]),
        tangential_directions=np.vstack([-cosine * identity, cosine * identity, sine * identity]),
        normal_gap=still,
        relative_velocity=still,
        friction_coefficient=chain.friction_coefficient,
    )
    matrix, _ = assemble(step)
    return np.array([matrix[cell::n, cell::n] for cell in range(n)])
