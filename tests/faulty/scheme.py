"""Equation (5) over a batch of chains in NumPy, with a place where each part of it can be spoilt."""

from collections.abc import Callable, Mapping, Sequence
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
}  # fmt: skip
"""Presets of the family; one of these names is another preset where a fault says so."""

Friction = Callable[["Batch", FloatArray, FloatArray, FloatArray, FloatArray], FloatArray]
"""Gives friction, shape (lanes, n), from the bound, from what would stop the contacts, from their velocities of slip
before the step, and from the friction of the step before."""

Rows = list[FloatArray] | None
"""Where positions, velocities and friction after each step go; ``None`` where nobody asks for them."""

REST = 1e-12
"""Of the fastest mass: a contact that slips less is at rest."""


def coulomb(batch: "Batch", bound: FloatArray, stop: FloatArray, slip: FloatArray, _before: FloatArray) -> FloatArray:
    """Stop the slip within the bound, which is larger for a contact that is at rest, or comes to rest."""
    sliding = np.minimum(np.maximum(stop, -bound), bound)  # half the time of np.clip
    if not batch.holds_more:
        return sliding
    rests = (np.abs(slip) <= REST * batch.fastest) | (slip * stop >= 0)
    return np.where(np.abs(stop) <= np.where(rests, batch.static_ratio, 1.0) * bound, stop, sliding)


@dataclass(frozen=True, kw_only=True)
class Fault:
    """What is wrong with an engine; without anything it is sound."""

    what: str = field(kw_only=False)
    """In words, for a table."""
    chain: Mapping[str, float] = field(default_factory=dict)
    """Factors on parameters of the chain, by name."""
    batch: Callable[["Batch"], None] = lambda _batch: None
    """Spoils numbers of a batch."""
    friction: Friction = coulomb
    """Gives the friction of a step."""
    pressing: Callable[[FloatArray], FloatArray] = lambda pressing: pressing
    """Gives the normal force that friction sees, over its mean, of that of the lanes, shape (steps, lanes, n)."""
    old_velocity: float = 0.0
    """Part of the velocity before a step by which positions are advanced, instead of that after it."""
    state: Callable[["Batch", FloatArray, FloatArray, int], None] = lambda *_: None
    """Spoils positions and velocities after a step, in place."""
    around: Callable[["Batch", State, int, int, Rows], State] = lambda batch, *asked: batch.advanced(*asked)
    """What is done when steps are asked for."""
    record: Callable[[Lane, Trajectory], Trajectory] = lambda _lane, run: run
    """Gives what is recorded instead of a motion."""
    remembers: bool = False
    """Whether the friction of a step depends on that of the step before."""
    presets: Mapping[str, Preset] = field(default_factory=lambda: {name: PRESETS[name] for name in ("tuned", "other")})
    """Its presets."""


class Batch:
    """Chains of as many cells, advanced together; a `Simulation`."""

    def __init__(self, lanes: Sequence[Lane], fault: Fault, preset: Preset = PRESETS["tuned"]):
        self.lanes, self.driven, self.preset, self._fault = tuple(lanes), tuple(lanes), preset, fault
        chains = [replace(lane.chain, **{name: factor * getattr(lane.chain, name)
                                         for name, factor in fault.chain.items()}) for lane in lanes]  # fmt: skip

        def of(name: str) -> FloatArray:
            return np.array([getattr(chain, name) for chain in chains])

        self.step = np.array([[lane.time_step] for lane in lanes])
        self.delay = np.zeros_like(self.step)
        self.scale = np.array([[lane.drive.displacement_scale(lane.chain)] for lane in lanes])
        self.mass = np.hstack([of("outer_mass"), of("inner_mass")])
        self.forces = -np.concatenate([of("stiffness_matrix"), of("damping_matrix")], axis=2)
        self.bound = of("friction_bound")
        self.static_ratio = np.array([[lane.static_ratio] for lane in lanes])
        self.push = np.zeros_like(self.mass)
        self.stopping = preset["part"] if "part" in preset.options else 1.0
        self.memory: dict[str, Any] = {}
        fault.batch(self)

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane; see `Simulation.run`."""
        rows: list[FloatArray] = []
        normal = self._normal(state, start, steps)
        end = self._fault.around(self, state, start, steps, rows)
        n, motions = self.bound.shape[1], np.array(rows).swapaxes(0, 1)
        return [
            self._fault.record(
                lane,
                Trajectory(
                    time=lane.times(start, steps),
                    positions=motion[:, : 2 * n],
                    velocities=motion[:, 2 * n : 4 * n],
                    friction=motion[:, 4 * n :],
                    normal_force=lane.preloads(start, steps) if normal is None else normal.normal_force[:, number],
                    internal_state=None if end.internal_state is None else end.internal_state[number],
                    normal_gap=normal.gap[:, number] if normal is not None and self._opens else None,
                ),
            )
            for number, (lane, motion) in enumerate(zip(self.lanes, motions, strict=True))
        ]

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance every lane, keep the final state; see `Simulation.advance`."""
        return self._fault.around(self, state, start, steps, None)

    def advanced(self, state: State, start: int, steps: int, rows: Rows = None) -> State:
        """Give the final state; `rows` gets positions, velocities and friction after each step."""
        fault, n = self._fault, self.bound.shape[1]
        state.check_fits(len(self.lanes), n)
        loads, bounds, normal = self._loads(start, steps), [self.bound] * steps, self._normal(state, start, steps)
        if normal is not None:
            mean = np.array([lane.chain.normal_force for lane in self.lanes])
            parts = np.divide(normal.normal_force, mean, out=np.zeros_like(normal.normal_force), where=mean > 0)
            bounds = list(self.bound * fault.pressing(parts))
        x, v, factor = state.positions.copy(), state.velocities.copy(), self.step / self.mass
        self.reduced = self.stopping / (factor[:, :n] + factor[:, n:])
        kept = fault.remembers and state.internal_state is not None
        friction = state.internal_state[:, -n:].copy() if kept else np.zeros_like(self.bound)
        self.holds_more = bool(np.any(self.static_ratio != 1))
        for k in range(steps):
            force = self.push + np.matmul(self.forces, np.hstack([x, v])[:, :, None])[:, :, 0]
            force[:, 0] += loads[:, k]
            gained = factor * force
            free = v + gained
            if self.holds_more:
                self.fastest = np.max(np.abs(v), axis=1) + np.max(np.abs(gained), axis=1)
                self.fastest = self.fastest[:, None]
            stop = self.reduced * (free[:, :n] - free[:, n:])
            friction = fault.friction(self, bounds[k], stop, v[:, n:] - v[:, :n], friction)
            after = free + factor * np.hstack([-friction, friction])
            x += self.step * (after + fault.old_velocity * (v - after))
            v = after
            fault.state(self, x, v, start + k)
            if rows is not None:
                rows.append(np.hstack([x, v, friction]))
        own = [normal.gap[-1], normal.speed] if normal is not None and self._opens else []
        own += [friction] if fault.remembers else []
        return State(x, v, np.hstack(own) if own else None)

    @property
    def _opens(self) -> bool:
        return any(lane.opens for lane in self.lanes)

    def _loads(self, start: int, steps: int) -> FloatArray:
        """Loads at the starts of the steps, shape (lanes, steps)."""
        times = self.step_asked * np.arange(start, start + steps) - self.delay
        return np.array([own.drive.load(own.chain, time) for own, time in zip(self.driven, times, strict=True)])

    @property
    def step_asked(self) -> FloatArray:
        """Time step of every lane, whatever is wrong with that of the batch."""
        return np.array([[lane.time_step] for lane in self.lanes])

    def _normal(self, state: State, start: int, steps: int) -> NormalMotion | None:
        """Advance the normal direction, shape (steps, lanes, n); nothing is to be done where it is constant."""
        if all(lane.preload is None for lane in self.lanes):
            return None
        load = np.stack([lane.preloads(start, steps) for lane in self.lanes], axis=1)
        mass, n = np.array([lane.chain.inner_mass for lane in self.lanes]), self.bound.shape[1]
        own = None if state.internal_state is None or not self._opens else state.internal_state[:, : 2 * n]
        gap, speed = replace(state, internal_state=own).normal_state(n)
        return normal_motion(load, mass, self.step_asked, gap, speed)

    def subset(self, lanes: Sequence[int]) -> "Batch":
        """Give the lanes of these indices."""
        part = object.__new__(type(self))
        part.__dict__.update(self.__dict__)
        part.memory, chosen = {}, [int(lane) for lane in lanes]
        part.lanes, part.driven = (tuple(own[k] for k in chosen) for own in (self.lanes, self.driven))
        for name in ("step", "delay", "scale", "mass", "forces", "bound", "static_ratio", "push"):
            setattr(part, name, getattr(self, name)[chosen])
        return part

    def close(self) -> None:
        """Nothing is held outside Python."""
