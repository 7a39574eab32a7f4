"""The model of a sphere that friction lifts off the depth at which λ_N holds it, with Drake's kSap or kSimilar."""

from typing import Any

import numba
import numpy as np

from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.stepping.linear_implicit import LinearStep, smooth_impulse
from reference_lcp.stepping.sequential import LaneModel
from reference_lcp.validation import FloatArray

MOST_SWEEPS = 100
"""Gauss–Seidel sweeps at most over the contacts, which hardly touch each other."""

SWEPT = 1e-15
"""Largest change of a friction impulse in a sweep, over h μ λ_N, that ends the sweeps."""


class GlidingLane(LaneModel):
    """One chain of spheres; its internal state is the place of every sphere, then its place a step later.

    Parameters
    ----------
    lane, step
        The lane, and the linear part of its motion along the row.
    depth
        Of a sphere at rest [m].
    softness
        R_t [1/kg] of kSap, shape (n,); zeros for kSimilar.
    smoothing
        Velocity [m/s], shape (n,), within which friction of kSimilar is off its bound; zeros for kSap.
    """

    def __init__(
        self,
        lane: Lane,
        step: LinearStep,
        depth: float,
        *,
        softness: FloatArray | None = None,
        smoothing: FloatArray | None = None,
    ):
        chain = lane.chain
        none = np.zeros(chain.cells)
        self.lane, self._step, self._depth = lane, step, depth
        self._contact = (
            np.where(chain.friction_bound > 0, chain.friction_coefficient, 0.0),
            chain.normal_force.copy(),
            chain.inner_mass.copy(),
            none if softness is None else softness,
            none if smoothing is None else smoothing,
        )

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state` at step index `start`."""
        lane, cells = self.lane, self.lane.chain.cells
        record = np.empty((steps, 6 * cells))
        _, across = self._integrate(state, start, steps, record)
        position, velocity, friction, normal = np.split(record, [2 * cells, 4 * cells, 5 * cells], axis=1)
        return Trajectory(lane.times(start, steps), position, velocity, friction, normal, self._internal_state(across))

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance as `run` does, and keep the end only."""
        motion, across = self._integrate(state, start, steps, np.empty((0, 6 * self.lane.chain.cells)))
        return State(motion[:1], motion[1:], self._internal_state(across)[None])

    def _integrate(self, state: State, start: int, steps: int, record: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Run the kernel; gives positions and velocities at the end, shape (2, 2n), and across, (2, n)."""
        step, motion, across = self._step, np.vstack([state.positions[0], state.velocities[0]]), self._across(state)
        _advance(
            motion,
            across,
            self.lane.loads(start, steps),
            (step.state, np.ascontiguousarray(step.load[:, 0]), step.response, step.coupling),
            (step.length, self._depth),
            self._contact,
            record,
        )
        return motion, across

    def _across(self, state: State) -> FloatArray:
        """Give places and velocities of the spheres, at rest where the state has none."""
        cells = self.lane.chain.cells
        if state.internal_state is None:
            return np.vstack([np.where(self._contact[0] > 0, -self._depth, 0.0), np.zeros(cells)])
        place, later = np.split(state.internal_state[0], 2)
        return np.vstack([place, (later - place) / self._step.length])

    def _internal_state(self, across: FloatArray) -> FloatArray:
        place, velocity = across
        return np.concatenate([place, place + self._step.length * velocity])


@numba.njit(cache=True, error_model="numpy")
def _advance(motion: Any, across: Any, loads: Any, matrices: Any, numbers: Any, contact: Any, record: Any) -> None:
    """Advance one lane in place; `record` is (steps, 6n), or has no rows when nothing is kept."""
    state_matrix, load_matrix, response, coupling = matrices
    h, depth = numbers
    coefficient, normal_force, mass = contact[:3]
    cells = coupling.shape[0]
    count = 2 * cells
    state = np.concatenate((motion[1], motion[0]))
    friction, normal = np.zeros(cells), h * normal_force
    for step in range(loads.size):
        free = state_matrix @ state + load_matrix * loads[step]
        for _ in range(MOST_SWEEPS):
            if _sweep(free[count:], coupling, across, (h, depth), contact, friction, normal) <= SWEPT:
                break
        state[:count] = free[:count] + response @ friction
        state[count:] += h * state[:count]
        for i in range(cells):
            if coefficient[i] > 0:
                across[1, i] += (normal[i] - h * normal_force[i]) / mass[i]
                across[0, i] += h * across[1, i]
        if record.shape[0] > 0:
            record[step, :count], record[step, count : 2 * count] = state[count:], state[:count]
            record[step, 2 * count : 2 * count + cells] = friction / h
            record[step, 2 * count + cells :] = normal / h
    motion[0], motion[1] = state[count:], state[:count]


@numba.njit(cache=True, error_model="numpy")
def _sweep(free: Any, coupling: Any, across: Any, numbers: Any, contact: Any, friction: Any, normal: Any) -> Any:
    """Solve every contact once, with the friction of the others as it is; gives the largest change over h μ λ_N."""
    h, depth = numbers
    coefficient, normal_force, mass, softness, smoothing = contact
    cells, largest = free.size, 0.0
    for i in range(cells):
        if coefficient[i] == 0:
            continue
        if across[0, i] >= 0:  # Drake finds no contact at the start of the step
            friction[i], normal[i] = 0.0, 0.0
            continue
        slip = free[i]
        for j in range(cells):
            if j != i:
                slip += coupling[i, j] * friction[j]
        before = friction[i]
        rate = across[1, i] - h * normal_force[i] / mass[i]
        cell = (slip, coupling[i, i], rate, across[0, i], normal_force[i] / depth, mass[i], coefficient[i], h)
        if smoothing[i] > 0:
            friction[i], normal[i] = _similar(cell, smoothing[i], normal[i])
        else:
            friction[i], normal[i] = _sap(cell, softness[i])
        largest = max(largest, abs(friction[i] - before) / (h * coefficient[i] * normal_force[i]))
    return largest


@numba.njit(cache=True, error_model="numpy")
def _sap(cell: Any, softness: Any) -> Any:
    """Give friction and normal impulse of kSap without a relaxation time: stick if the cone allows it, else slide."""
    slip, coupling, rate, place, stiffness, mass, coefficient, h = cell
    compliance = 1 / (h * h * stiffness)
    lacking = -place / h - rate
    friction, normal = -slip / (softness + coupling), lacking / (compliance + 1 / mass)
    if abs(friction) > coefficient * normal:
        share = coefficient * coefficient * (softness + coupling)
        normal = max((lacking + coefficient * abs(slip)) / (compliance + 1 / mass + share), 0.0)
        friction = -np.sign(slip) * coefficient * normal
    return friction, normal


@numba.njit(cache=True, error_model="numpy")
def _similar(cell: Any, smoothing: Any, start: Any) -> Any:
    """Give friction and normal impulse of kSimilar: Newton's method on the normal one, kept in its bracket."""
    slip, coupling, rate, place, stiffness, mass, coefficient, h = cell
    low, high = 0.0, h * stiffness * (abs(place) + h * (abs(rate) + coefficient * abs(slip)))
    normal, friction = min(start, high), 0.0
    for _ in range(100):
        friction = smooth_impulse(slip, coupling, coefficient * normal, smoothing)
        speed = abs(slip + coupling * friction)
        root = np.sqrt(speed * speed + smoothing * smoothing)
        approach = rate + normal / mass - coefficient * (root - smoothing)
        force = -stiffness * (place + h * approach)
        excess, slope = normal - h * max(force, 0.0), 1.0
        if excess > 0:
            high = normal
        else:
            low = normal
        if force > 0:
            steep = 1 + coupling * coefficient * normal * smoothing * smoothing / root**3
            slope += h * h * stiffness * (1 / mass + coupling * (coefficient * speed / root) ** 2 / steep)
        following = normal - excess / slope
        if not low < following < high:
            following = (low + high) / 2
        if abs(following - normal) <= 1e-16 * high:
            break
        normal = following
    return friction, normal
