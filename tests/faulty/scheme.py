"""Equation (5) over a batch of chains in NumPy, with a place where each part of it can be spoilt."""

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from multibody_xval.engines import NormalForce, Option, Preset
from reference_lcp.chain.preload import NormalMotion, normal_motion
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.validation import FloatArray

PRESETS = {
    "tuned": Preset("Claims the reference's own step.", shares_scheme=True, judged=("chain", "blocks"),
                    normal_force=NormalForce.LIFTING, static_friction=True),
    "other": Preset("The same steps, judged beside the exact motion.", judged=("chain", "blocks")),
    "default": Preset("Friction that stops a contact in four steps.",
                      {"part": Option(0.25, 1.0, "what a step takes from the velocity of a slip that ends")}),
    "scenes": Preset("Of a solver that runs no chain.", scenes_only=True, optional=True),
}  # fmt: skip
"""Presets of the family; one of these names is another preset where a fault says so."""

Rows = list[FloatArray] | None
"""Where positions, velocities and friction after each step go; ``None`` where nobody asks for them."""


def coulomb(batch: "Batch", bound: FloatArray, stop: FloatArray, slip: FloatArray, _before: FloatArray) -> FloatArray:
    """Stop the slip within the bound, which is larger for a contact that is at rest, or comes to rest.

    All are of shape (lanes, n): bounds, what would stop the contacts, their slip before the step, and friction then.
    """
    sliding = np.minimum(np.maximum(stop, -bound), bound)  # half the time of np.clip
    if np.all(batch.static_ratio == 1):
        return sliding
    rests = (np.abs(slip) <= 1e-12 * batch.fastest) | (slip * stop >= 0)
    return np.where(np.abs(stop) <= np.where(rests, batch.static_ratio, 1.0) * bound, stop, sliding)


@dataclass(frozen=True, kw_only=True)
class Fault:
    """What is wrong with an engine, in words and by what is done instead; without anything it is sound."""

    what: str = field(kw_only=False)
    chain: Mapping[str, float] = field(default_factory=dict)  # factors on parameters of the chain
    numbers: Mapping[str, Callable[["Batch"], Any]] = field(default_factory=dict)  # other attributes of a batch
    friction: Callable[..., FloatArray] = coulomb
    pressing: Callable[[FloatArray], FloatArray] = lambda parts: parts  # normal force that friction sees, over its mean
    old_velocity: float = 0.0  # part of the velocity before a step by which positions are advanced
    state: Callable[["Batch", FloatArray, FloatArray, int], None] = lambda *_: (
        None
    )  # positions, velocities after a step
    around: Callable[["Batch", State, int, int, Rows], State] = lambda batch, *asked: batch.advanced(*asked)
    record: Callable[[Lane, Trajectory], Trajectory] = lambda _lane, run: run
    radian: float = 0.0  # in the unit of the hinge in its scenes; without one it has none
    presets: Mapping[str, Preset] = field(default_factory=lambda: {name: PRESETS[name] for name in ("tuned", "other")})


class Batch:
    """Chains of as many cells, advanced together; a `Simulation`."""

    def __init__(self, lanes: Sequence[Lane], fault: Fault, preset: Preset = PRESETS["tuned"]):
        self.lanes, self.driven, self.preset, self._fault = tuple(lanes), tuple(lanes), preset, fault
        scaled = [{name: own * getattr(lane.chain, name) for name, own in fault.chain.items()} for lane in lanes]
        chains = [replace(lane.chain, **own) for lane, own in zip(lanes, scaled, strict=True)]

        def of(name: str) -> FloatArray:
            return np.array([getattr(chain, name) for chain in chains])

        self.step_asked = np.array([[lane.time_step] for lane in lanes])
        self.step, self.delay = self.step_asked.copy(), np.zeros_like(self.step_asked)
        self.scale = np.array([[lane.drive.displacement_scale(lane.chain)] for lane in lanes])
        self.mass = np.hstack([of("outer_mass"), of("inner_mass")])
        self.forces = -np.concatenate([of("stiffness_matrix"), of("damping_matrix")], axis=2)
        self.bound = of("friction_bound")
        self.static_ratio = np.array([[lane.static_ratio] for lane in lanes])
        self.push = np.zeros_like(self.mass)
        self.stopping = preset["part"] if "part" in preset.options else 1.0
        self.opens = any(lane.opens for lane in lanes)
        self.memory: dict[str, Any] = {}
        for name, value in [(name, change(self)) for name, change in fault.numbers.items()]:
            setattr(self, name, value)

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane; see `Simulation.run`."""
        rows: list[FloatArray] = []
        normal, end = self._normal(state, start, steps), self._fault.around(self, state, start, steps, rows)
        motions = np.split(np.array(rows), [own * self.bound.shape[1] for own in (2, 4)], axis=2)
        runs = []
        for number, lane in enumerate(self.lanes):
            opened = (end.internal_state[number], normal.gap[:, number]) if self.opens else (None, None)
            arrays = [own[:, number] for own in (*motions, normal.normal_force)]
            runs.append(self._fault.record(lane, Trajectory(lane.times(start, steps), *arrays, *opened)))
        return runs

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance every lane, keep the final state; see `Simulation.advance`."""
        return self._fault.around(self, state, start, steps, None)

    def advanced(self, state: State, start: int, steps: int, rows: Rows = None) -> State:
        """Give the final state; `rows` gets positions, velocities and friction after each step."""
        fault, n = self._fault, self.bound.shape[1]
        state.check_fits(len(self.lanes), 2 * n)
        times = self.step_asked * np.arange(start, start + steps) - self.delay
        loads = np.array([own.drive.load(own.chain, time) for own, time in zip(self.driven, times, strict=True)])
        normal = self._normal(state, start, steps)
        bounds = self._bounds(normal)
        x, v, factor = state.positions.copy(), state.velocities.copy(), self.step / self.mass
        self.reduced = self.stopping / (factor[:, :n] + factor[:, n:])
        friction = np.zeros_like(self.bound)
        for k in range(steps):
            force = self.push + np.matmul(self.forces, np.hstack([x, v])[:, :, None])[:, :, 0]
            force[:, 0] += loads[:, k]
            gained = factor * force
            self.fastest = np.max(np.abs(v) + np.abs(gained), axis=1, keepdims=True)
            stop = self.reduced * ((v + gained)[:, :n] - (v + gained)[:, n:])
            friction = fault.friction(self, bounds[k], stop, v[:, n:] - v[:, :n], friction)
            after = v + gained + factor * np.hstack([-friction, friction])
            x += self.step * (after + fault.old_velocity * (v - after))
            v = after
            fault.state(self, x, v, start + k)
            if rows is not None:
                rows.append(np.hstack([x, v, friction]))
        return State(x, v, np.hstack([normal.gap[-1], normal.speed]) if self.opens else None)

    def _bounds(self, normal: NormalMotion) -> FloatArray:
        """Give the bounds of friction in every step, shape (steps, lanes, n)."""
        mean = np.array([lane.chain.normal_force for lane in self.lanes])
        parts = np.divide(normal.normal_force, mean, out=np.zeros_like(normal.normal_force), where=mean > 0)
        return self.bound * self._fault.pressing(parts)

    def _normal(self, state: State, start: int, steps: int) -> NormalMotion:
        """Advance the normal direction, shape (steps, lanes, n)."""
        load = np.stack([lane.preloads(start, steps) for lane in self.lanes], axis=1)
        mass = np.array([lane.chain.inner_mass for lane in self.lanes])
        own = replace(state, internal_state=state.internal_state if self.opens else None)
        return normal_motion(load, mass, self.step_asked, *own.normal_state(self.bound.shape[1]))

    def subset(self, lanes: Sequence[int]) -> "Batch":
        """Give the lanes of these indices."""
        part, chosen = copy(self), [int(lane) for lane in lanes]
        part.memory = {}
        part.lanes, part.driven = (tuple(own[k] for k in chosen) for own in (self.lanes, self.driven))
        for name, value in vars(self).items():
            if isinstance(value, np.ndarray):
                setattr(part, name, value[chosen])
        return part

    def close(self) -> None:
        """Nothing is held outside Python."""
