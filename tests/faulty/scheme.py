"""Equation (5) over a batch of chains in NumPy, with a place where each part of it can be spoilt."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.validation import FloatArray

Friction = Callable[["Batch", FloatArray, FloatArray], FloatArray]
"""Gives the friction of all lanes, of what would stop their contacts, and of the friction of the step before."""


def coulomb(batch: "Batch", stop: FloatArray, _before: FloatArray) -> FloatArray:
    """Stop the slip, within the bound."""
    return np.clip(stop, -batch.bound, batch.bound)


@dataclass(frozen=True, kw_only=True)
class Fault:
    """What is wrong with an engine; without anything it is sound."""

    what: str
    """In words, for a table."""
    chain: Mapping[str, float] = field(default_factory=dict)
    """Factors on parameters of the chain, by name."""
    batch: Callable[["Batch"], None] = lambda _batch: None
    """Spoils numbers of a batch."""
    friction: Friction = coulomb
    """Gives the friction of a step."""
    old_velocity: float = 0.0
    """Part of the velocity before a step by which positions are advanced, instead of that after it."""
    late: int = 0
    """Steps by which the drive is late."""
    state: Callable[["Batch", FloatArray, FloatArray, int], None] = lambda *_: None
    """Spoils positions and velocities after a step, in place."""
    record: Callable[[Trajectory], Trajectory] = lambda run: run
    """Gives what is recorded instead of a motion."""
    remembers: bool = False
    """Whether the friction of a step depends on that of the step before."""


class Batch:
    """Chains of as many cells, advanced together; a `Simulation`."""

    def __init__(self, lanes: Sequence[Lane], fault: Fault):
        self.lanes, self._fault = tuple(lanes), fault
        own = [_changed(lane, fault.chain) for lane in lanes]
        self._driven = own

        def of(name: str) -> FloatArray:
            return np.array([getattr(lane.chain, name) for lane in own])

        self.step = np.array([[lane.time_step] for lane in own])
        self.scale = np.array([[lane.drive.displacement_scale(lane.chain)] for lane in own])
        self.mass = np.hstack([of("outer_mass"), of("inner_mass")])
        self.forces = -np.concatenate([of("stiffness_matrix"), of("damping_matrix")], axis=2)
        self.bound = of("friction_bound")
        self.push = np.zeros_like(self.mass)
        fault.batch(self)

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane; see `Simulation.run`."""
        rows: list[FloatArray] = []
        end = self._advanced(state, start, steps, rows)
        n = self.bound.shape[1]
        lanes = [np.array(lane) for lane in zip(*rows, strict=True)]
        return [
            self._fault.record(
                Trajectory(
                    time=lane.times(start, steps),
                    positions=motion[:, : 2 * n],
                    velocities=motion[:, 2 * n : 4 * n],
                    friction=motion[:, 4 * n :],
                    normal_force=lane.preloads(start, steps),
                    internal_state=None if end.internal_state is None else end.internal_state[number],
                )
            )
            for number, (lane, motion) in enumerate(zip(self.lanes, lanes, strict=True))
        ]

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance every lane, keep the final state; see `Simulation.advance`."""
        return self._advanced(state, start, steps, None)

    def _advanced(self, state: State, start: int, steps: int, rows: list[FloatArray] | None) -> State:
        """Give the final state; `rows` gets positions, velocities and friction after each step."""
        fault, n = self._fault, self.bound.shape[1]
        state.check_fits(len(self.lanes), n)
        loads = np.array([lane.loads(start - fault.late, steps) for lane in self._driven])
        x, v, factor = state.positions.copy(), state.velocities.copy(), self.step / self.mass
        reduced = 1 / (factor[:, :n] + factor[:, n:])
        friction = np.zeros_like(self.bound) if state.internal_state is None else state.internal_state.copy()
        for k in range(steps):
            force = self.push + np.matmul(self.forces, np.hstack([x, v])[:, :, None])[:, :, 0]
            force[:, 0] += loads[:, k]
            free = v + factor * force
            friction = fault.friction(self, reduced * (free[:, :n] - free[:, n:]), friction)
            after = free + factor * np.hstack([-friction, friction])
            x += self.step * (after + fault.old_velocity * (v - after))
            v = after
            fault.state(self, x, v, start + k)
            if rows is not None:
                rows.append(np.hstack([x, v, friction]))
        return State(x, v, friction if fault.remembers else None)

    def subset(self, lanes: Sequence[int]) -> "Batch":
        """Give the lanes of these indices."""
        part = object.__new__(type(self))
        part.__dict__.update(self.__dict__)
        chosen = [int(lane) for lane in lanes]
        part.lanes, part._driven = (tuple(own[k] for k in chosen) for own in (self.lanes, self._driven))
        for name in ("step", "scale", "mass", "forces", "bound", "push"):
            setattr(part, name, getattr(self, name)[chosen])
        return part

    def close(self) -> None:
        """Nothing is held outside Python."""


def _changed(lane: Lane, factors: Mapping[str, float]) -> Lane:
    """Give a lane of another chain."""
    changed = {name: factor * getattr(lane.chain, name) for name, factor in factors.items()}
    return replace(lane, chain=replace(lane.chain, **changed))
