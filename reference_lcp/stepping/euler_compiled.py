"""Equation (5) for many lanes at once, with the closed solution of each cell's LCP, compiled.

With a given normal force the friction block G_TT of equation (7) is diagonal: each contact touches
only the two masses of its own cell. The LCP then splits cell by cell, and each has the solution

    Λ_T = clip(−ġ_free / (1/m_o + 1/m_i), −μ λ_N Δt, μ λ_N Δt),

with ġ_free the relative velocity that the step would end with if the contact were frictionless. Where the
normal force changes in time, the normal direction is advanced first: it does not depend on the row's motion.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from reference_lcp.chain.preload import NormalMotion, normal_motion
from reference_lcp.chain.simulation import Lane, common_cells
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.validation import FloatArray, checked_count

BLOCK_LANES = 64
"""Lanes advanced together: their state and parameters stay in the first-level cache."""


# Both parts of a step are inlined: passing their arrays would cost one short chain 100 ns a step, more than its work.
@numba.njit(inline="always", nogil=True, error_model="numpy")
def _chain_force(pull: Any, u: Any, du: Any, stiffness: Any, damping: Any, load: Any) -> None:
    """Force of the chain element at the left of each cell, less the load of the drive; row n stays zero."""
    cells, lanes = u.shape
    for lane in range(lanes):
        pull[0, lane] = stiffness[0, lane] * u[0, lane] + damping[0, lane] * du[0, lane] - load[lane]
    for i in range(1, cells):
        for lane in range(lanes):
            stretch = u[i, lane] - u[i - 1, lane]
            rate = du[i, lane] - du[i - 1, lane]
            pull[i, lane] = stiffness[i, lane] * stretch + damping[i, lane] * rate


@numba.njit(inline="always", nogil=True, error_model="numpy")
def _step(u: Any, du: Any, v: Any, dv: Any, friction: Any, pull: Any, p: Any, dt: Any) -> None:
    """Equation (5) for every cell of every lane, in place; `friction` receives λ_T.

    Only rows of one cell are read and written together, and the pull of its neighbours comes from an
    array of its own: so the compiler sees that lanes are independent, and vectorises over them.
    """
    stiffness, damping, per_outer, per_inner, reduced_mass, bound = p[2], p[3], p[4], p[5], p[6], p[7]
    cells, lanes = u.shape
    for i in range(cells):
        for lane in range(lanes):
            inner = stiffness[i, lane] * (v[i, lane] - u[i, lane]) + damping[i, lane] * (dv[i, lane] - du[i, lane])
            outer_free = du[i, lane] + per_outer[i, lane] * (pull[i + 1, lane] - pull[i, lane] + inner)
            inner_free = dv[i, lane] - per_inner[i, lane] * inner
            force = reduced_mass[i, lane] * (outer_free - inner_free)
            force = force if force < bound[i, lane] else bound[i, lane]
            force = force if force > -bound[i, lane] else -bound[i, lane]
            friction[i, lane] = force
            outer_end = outer_free - per_outer[i, lane] * force
            inner_end = inner_free + per_inner[i, lane] * force
            du[i, lane] = outer_end
            dv[i, lane] = inner_end
            u[i, lane] += dt[lane] * outer_end
            v[i, lane] += dt[lane] * inner_end


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _advance_block(x: Any, p: Any, dt: Any, loads: Any, bounds: Any, record: Any) -> Any:
    """Advance one block of lanes and give its final state.

    `x` is the state (4n, lanes): u, v, u̇, v̇. `p` holds the parameters (8, n, lanes). `loads` is
    (steps, lanes). `bounds` is (steps, n, lanes), or has no steps where the bounds of `p` hold all the
    time. `record` is (steps, 5n, lanes), or has no steps when nothing is kept.
    """
    n = x.shape[0] // 4
    u, v, du, dv = x[:n].copy(), x[n : 2 * n].copy(), x[2 * n : 3 * n].copy(), x[3 * n :].copy()
    friction = np.zeros(u.shape)
    pull = np.zeros((n + 1, u.shape[1]))
    for step in range(loads.shape[0]):
        if bounds.shape[0] > 0:
            p[7] = bounds[step]
        _chain_force(pull, u, du, p[0], p[1], loads[step])
        _step(u, du, v, dv, friction, pull, p, dt)
        if record.shape[0] > 0:
            record[step, :n] = u
            record[step, n : 2 * n] = v
            record[step, 2 * n : 3 * n] = du
            record[step, 3 * n : 4 * n] = dv
            record[step, 4 * n :] = friction
    return np.concatenate((u, v, du, dv))


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _advance(x: Any, p: Any, dt: Any, loads: Any, bounds: Any, record: Any) -> None:
    """Advance all lanes block by block, in place; arguments as in `_advance_block`, lanes last."""
    lanes = x.shape[1]
    for first in range(0, lanes, BLOCK_LANES):
        last = min(first + BLOCK_LANES, lanes)
        block_record = np.empty((record.shape[0], record.shape[1], last - first))
        x[:, first:last] = _advance_block(
            x[:, first:last].copy(),
            p[:, :, first:last].copy(),
            dt[first:last].copy(),
            loads[:, first:last].copy(),
            bounds[:, :, first:last].copy(),
            block_record,
        )
        if record.shape[0] > 0:
            record[:, :, first:last] = block_record


@dataclass(frozen=True)
class _Packed:
    """Parameters of all lanes, lanes last and contiguous."""

    parameters: FloatArray
    time_step: FloatArray

    @classmethod
    def of(cls, lanes: Sequence[Lane]) -> "_Packed":
        dt = np.array([lane.time_step for lane in lanes])
        rows = [
            (chain.chain_stiffness, chain.chain_damping, chain.inner_stiffness, chain.inner_damping,
             step / chain.outer_mass, step / chain.inner_mass,
             1 / (1 / chain.outer_mass + 1 / chain.inner_mass) / step, chain.friction_bound)
            for chain, step in ((lane.chain, lane.time_step) for lane in lanes)
        ]  # fmt: skip
        return cls(np.ascontiguousarray(np.array(rows).transpose(1, 2, 0)), dt)

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> "_Packed":
        return _Packed(np.ascontiguousarray(self.parameters[:, :, lanes]), self.time_step[lanes])


class CompiledSimulation:
    """The Euler scheme of equation (5) over a batch of lanes, compiled; a `Simulation`."""

    def __init__(self, lanes: Sequence[Lane], packed: _Packed | None = None):
        self._cells = common_cells(lanes)
        self.lanes = tuple(lanes)
        self._packed = packed if packed is not None else _Packed.of(self.lanes)
        self._modulated = any(lane.preload is not None for lane in self.lanes)
        self._opens = any(lane.opens for lane in self.lanes)
        self._loads: tuple[tuple[int, int], FloatArray] = ((0, 0), np.empty((0, len(self.lanes))))

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane; see `Simulation.run`."""
        record = np.empty((checked_count("steps", steps), 5 * self._cells, len(self.lanes)))
        normal = self._normal_motion(state, start, steps)
        self._integrate(state, start, steps, normal, record)
        by_lane = np.ascontiguousarray(record.transpose(2, 0, 1))
        return [self._trajectory(index, rows, start, normal) for index, rows in enumerate(by_lane)]

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance every lane, keep the final state; see `Simulation.advance`."""
        record = np.empty((0, 5 * self._cells, len(self.lanes)))
        normal = self._normal_motion(state, start, checked_count("steps", steps))
        x = self._integrate(state, start, steps, normal, record).T
        return State(
            np.ascontiguousarray(x[:, : 2 * self._cells]),
            np.ascontiguousarray(x[:, 2 * self._cells :]),
            None if normal is None or not self._opens else np.vstack([normal.gap[-1], normal.speed]).T.copy(),
        )

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> "CompiledSimulation":
        """Give the lanes of these indices."""
        part = CompiledSimulation([self.lanes[lane] for lane in lanes], self._packed.subset(lanes))
        part._loads = (self._loads[0], np.ascontiguousarray(self._loads[1][:, lanes]))
        return part

    @property
    def nbytes(self) -> int:
        """Bytes of the arrays that it holds: the parameters of all lanes and the last table of loads."""
        return self._packed.parameters.nbytes + self._packed.time_step.nbytes + self._loads[1].nbytes

    def close(self) -> None:
        """Nothing is held outside Python."""

    def _integrate(
        self, state: State, start: int, steps: int, normal: NormalMotion | None, record: FloatArray
    ) -> FloatArray:
        """Run the kernel; gives the final state (4n, lanes)."""
        state.check_fits(len(self.lanes), self._cells)
        x = np.ascontiguousarray(np.hstack([state.positions, state.velocities]).T)
        bounds = np.empty((0, self._cells, len(self.lanes)))
        if normal is not None:
            bounds = normal.normal_force * np.stack([lane.chain.friction_coefficient for lane in self.lanes], axis=1)
        parameters, loads = self._packed.parameters, self._load_table(start, steps)
        _advance(x, parameters, self._packed.time_step, loads, bounds, record)
        return x

    def _normal_motion(self, state: State, start: int, steps: int) -> NormalMotion | None:
        """Advance the normal direction of all lanes, cells by lanes; nothing is to be done where λ_N is constant."""
        if not self._modulated:
            return None
        normal_load = np.stack([lane.preloads(start, steps) for lane in self.lanes], axis=2)
        if not self._opens:
            closed = np.zeros(normal_load.shape[1:])
            return NormalMotion(normal_load, np.zeros_like(normal_load), closed)
        mass = np.stack([lane.chain.inner_mass for lane in self.lanes], axis=1)
        gap, speed = (part.T for part in state.normal_state(self._cells))
        return normal_motion(normal_load, mass, self._packed.time_step, gap, speed)

    def _load_table(self, start: int, steps: int) -> FloatArray:
        """Loads (steps, lanes); the last table is kept, since a period map needs the same again."""
        if self._loads[0] != (start, steps):
            table = np.array([lane.loads(start, steps) for lane in self.lanes]).T
            self._loads = ((start, steps), np.ascontiguousarray(table))
        return self._loads[1]

    def _trajectory(self, index: int, rows: FloatArray, start: int, normal: NormalMotion | None) -> Trajectory:
        n, lane, steps = self._cells, self.lanes[index], rows.shape[0]
        force, internal_state, gap = lane.preloads(start, steps), None, None
        if normal is not None and self._opens:
            force, gap = normal.normal_force[:, :, index].copy(), normal.gap[:, :, index].copy()
            internal_state = np.concatenate([gap[-1], normal.speed[:, index]])
        return Trajectory(
            time=lane.times(start, steps),
            positions=rows[:, : 2 * n],
            velocities=rows[:, 2 * n : 4 * n],
            friction=rows[:, 4 * n :],
            normal_force=force,
            internal_state=internal_state,
            normal_gap=gap,
        )
