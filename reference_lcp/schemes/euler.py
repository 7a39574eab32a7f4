"""The scheme of equation (5): compiled for many lanes at once, or step by step as the paper writes it.

`LemkeSimulation` solves equation (7) of every step by Lemke's method. `CompiledSimulation` has its closed solution:
with a given normal force its friction block G_TT is diagonal, since each contact touches only the two masses of its own
cell. The LCP then splits cell by cell, and each has the solution

    Λ_T = clip(−ġ_free / (1/m_o + 1/m_i), −μ λ_N Δt, μ λ_N Δt),

with ġ_free the relative velocity that the step would end with if the contact were frictionless. Where the
normal force changes in time, the normal direction is advanced first: it does not depend on the row's motion.
"""

import copy
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.preload import NormalMotion, normal_motion
from reference_lcp.chain.simulation import Lane, Simulation, check_one_coefficient, common_cells
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.lcp.systems import MassSpringSystem
from reference_lcp.lcp.time_step import FrictionalStep, solved_steps
from reference_lcp.schemes.bodies import EulerBodies
from reference_lcp.schemes.euler_kernel import advance
from reference_lcp.schemes.sequential import LaneModel, SequentialSimulation
from reference_lcp.validation import FloatArray, checked_count


class CompiledSimulation:
    """The Euler scheme of equation (5) over a batch of lanes, compiled; a `Simulation`."""

    def __init__(self, lanes: Sequence[Lane]):
        self._cells = common_cells(lanes)
        check_one_coefficient(lanes, "the compiled scheme")
        self.lanes = tuple(lanes)
        chains = [lane.chain for lane in lanes]

        def of_cells(name: str) -> FloatArray:
            return np.array([getattr(chain, name) for chain in chains])

        self._time_step = np.array([lane.time_step for lane in lanes])
        outer, inner, dt = of_cells("outer_mass"), of_cells("inner_mass"), self._time_step[:, None]
        springs = [of_cells(f"{place}_{kind}") for place in ("chain", "inner") for kind in ("stiffness", "damping")]
        bound = of_cells("friction_coefficient") * of_cells("normal_force")
        rows = [*springs, dt / outer, dt / inner, 1 / (1 / outer + 1 / inner) / dt, bound]
        self._parameters = np.hstack(rows)[:, None]
        self._modulated = np.array([lane.preload is not None for lane in lanes])
        self._opens = np.array([lane.opens for lane in lanes])
        self._loads: tuple[tuple[int, int], FloatArray] = ((0, 0), np.empty((len(self.lanes), 0)))
        self._load_rows = np.arange(len(self.lanes))

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane; see `Simulation.run`."""
        record = np.empty((len(self.lanes), checked_count("steps", steps), 5 * self._cells))
        normal = self._normal_motion(state, start, steps)
        self._integrate(state, start, steps, normal, record)
        return [self._trajectory(index, rows, start, normal) for index, rows in enumerate(record)]

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance every lane, keep the final state; see `Simulation.advance`."""
        record = np.empty((len(self.lanes), 0, 5 * self._cells))
        normal = self._normal_motion(state, start, checked_count("steps", steps))
        x = self._integrate(state, start, steps, normal, record)
        return State(
            np.ascontiguousarray(x[:, : 2 * self._cells]),
            np.ascontiguousarray(x[:, 2 * self._cells :]),
            None if normal is None or not np.any(self._opens) else np.vstack([normal.gap[-1], normal.speed]).T.copy(),
        )

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> "CompiledSimulation":
        """Give the lanes of these indices, each as often as it is listed."""
        part = copy.copy(self)
        part.lanes = tuple(self.lanes[lane] for lane in lanes)
        common_cells(part.lanes)
        for name in ("_time_step", "_parameters", "_modulated", "_opens", "_load_rows"):
            setattr(part, name, getattr(self, name)[lanes])
        return part

    def close(self) -> None:
        """Nothing is held outside Python."""

    def _integrate(
        self, state: State, start: int, steps: int, normal: NormalMotion | None, record: FloatArray
    ) -> FloatArray:
        """Run the kernel; gives the final state (lanes, 4n)."""
        state.check_fits(len(self.lanes), 2 * self._cells)
        x = np.hstack([state.positions, state.velocities])
        bounds = np.empty((0, self._cells, len(self.lanes)))
        if normal is not None:
            bounds = normal.normal_force * np.stack([lane.chain.friction_coefficient for lane in self.lanes], axis=1)
        loads = self._load_table(start, steps)
        advance(x[:, None], self._parameters, self._time_step, loads, self._load_rows, bounds, record)
        return x

    def _normal_motion(self, state: State, start: int, steps: int) -> NormalMotion | None:
        """Advance the normal direction of all lanes, cells by lanes; nothing is to be done where λ_N is constant."""
        if not np.any(self._modulated):
            return None
        normal_load = np.stack([lane.preloads(start, steps) for lane in self.lanes], axis=2)
        if not np.any(self._opens):
            closed = np.zeros(normal_load.shape[1:])
            return NormalMotion(normal_load, np.zeros_like(normal_load), closed)
        mass = np.stack([lane.chain.inner_mass for lane in self.lanes], axis=1)
        gap, speed = (part.T for part in state.normal_state(self._cells))
        return normal_motion(normal_load, mass, self._time_step, gap, speed)

    def _load_table(self, start: int, steps: int) -> FloatArray:
        """Loads (…, steps), see `_load_rows`; the last table is kept, since a period map needs the same again."""
        if self._loads[0] != (start, steps):
            lanes = {id(lane): lane for lane in self.lanes}
            rows = {key: row for row, key in enumerate(lanes)}
            self._loads = ((start, steps), np.array([lane.loads(start, steps) for lane in lanes.values()]))
            self._load_rows = np.array([rows[id(lane)] for lane in self.lanes])
        return self._loads[1]

    def _trajectory(self, index: int, rows: FloatArray, start: int, normal: NormalMotion | None) -> Trajectory:
        n, lane, steps = self._cells, self.lanes[index], rows.shape[0]
        force, internal_state, gap = lane.preloads(start, steps), None, None
        if normal is not None and np.any(self._opens):
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


def euler_simulation(lanes: Sequence[Lane]) -> Simulation:
    """Give the compiled scheme of equation (5); with static friction, equation (7) by Lemke's method."""
    if isinstance(lanes[0].chain, MassSpringSystem):
        return SequentialSimulation([EulerBodies(lane) for lane in lanes])
    if any(lane.static_ratio > 1 for lane in lanes):
        return LemkeSimulation(tuple(lanes))
    return CompiledSimulation(lanes)


class LemkeSimulation(SequentialSimulation):
    """The Euler scheme with Lemke's method in every step; a `Simulation`, slower than the closed form."""

    def __init__(self, lanes: list[Lane] | tuple[Lane, ...]):
        common_cells(lanes)
        super().__init__([_LemkeLane(lane) for lane in lanes])


class _LemkeLane(LaneModel):
    """One chain under one drive, advanced step by step."""

    def __init__(self, lane: Lane):
        self.lane = lane

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state` at step index `start`."""
        lane, chain, dt = self.lane, self.lane.chain, self.lane.time_step
        gap, speed = (part[0] for part in state.normal_state(chain.cells)) if lane.opens else np.zeros((2, 1))
        normal = normal_motion(lane.preloads(start, steps), chain.inner_mass, dt, gap, speed)
        loads = lane.loads(start, steps)

        def step_from(index: int, u: FloatArray, q: FloatArray) -> FrictionalStep:
            row = index - start
            return chain_step(chain, u, q, loads[row], dt, normal.normal_force[row], lane.static_ratio)

        motion = list(solved_steps(step_from, range(start, start + steps), state.positions[0], state.velocities[0]))
        positions, velocities = np.array([u for u, _, _ in motion]), np.array([q for _, q, _ in motion])
        friction = np.array([impulses.tangential / dt for _, _, impulses in motion])
        own = (np.concatenate([normal.gap[-1], normal.speed]), normal.gap) if lane.opens else (None, None)
        return Trajectory(lane.times(start, steps), positions, velocities, friction, normal.normal_force, *own)


def chain_step(
    chain: Chain,
    u: FloatArray,
    q: FloatArray,
    load: float,
    time_step: float,
    normal_force: FloatArray,
    static_ratio: float = 1.0,
) -> FrictionalStep:
    """Equation (7)'s data for one step of the chain: h = f − K u − C q, contact directions W_T."""
    force = -chain.stiffness_matrix @ u - chain.damping_matrix @ q
    force[0] += load
    return FrictionalStep.under_normal_force(
        chain.contact_directions,
        q,
        mass_matrix=chain.mass_matrix,
        force=force,
        time_step=time_step,
        friction_coefficient=chain.friction_coefficient,
        static_friction_coefficient=static_ratio * chain.friction_coefficient,
        normal_force=normal_force,
    )
