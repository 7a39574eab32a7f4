"""Models of laws whose steps a compiled kernel takes."""

import functools
from collections.abc import Callable
from typing import Any, Generic, ParamSpec, TypeVar

import numpy as np

from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.schemes.sequential import LaneModel
from reference_lcp.validation import FloatArray

P = ParamSpec("P")
R = TypeVar("R")


class Kernel(Generic[P, R]):
    """A function that numba compiles when it is first called, with the kernels that it calls.

    Numba is imported then, and not with the adapter. What a kernel calls becomes a part of it: a call counts references
    to each array that it hands on, which takes longer than what most of them do.
    """

    def __init__(self, function: Callable[P, R]):
        self._function = function

    def __call__(self, *arguments: P.args, **named: P.kwargs) -> R:
        """Call what is compiled."""
        return self._compiled(*arguments, **named)

    @functools.cached_property
    def _compiled(self) -> Any:
        return self._compile(inlined=False)

    @functools.cached_property
    def _inlined(self) -> Any:
        return self._compile(inlined=True)

    def _compile(self, *, inlined: bool) -> Any:
        import numba

        module = self._function.__globals__
        for name in self._function.__code__.co_names:
            if isinstance(called := module.get(name), Kernel):
                module[name] = called._inlined
        return numba.njit(cache=True, error_model="numpy", forceinline=inlined)(self._function)


@Kernel
def keep(row: Any, position: Any, velocity: Any, impulse: Any, length: Any) -> None:
    """Write positions, velocities and friction, impulses over the length of their step, into a row of a record.

    By loops: to assign to parts of a row takes two seconds to be compiled for.
    """
    count = position.size
    for i in range(count):
        row[i], row[count + i] = position[i], velocity[i]
    for i in range(impulse.size):
        row[2 * count + i] = impulse[i] / length


class KernelLane(LaneModel):
    """One chain, whose steps a kernel takes: that of `_take` with `numbers`, or a model adds its own."""

    columns = 5
    """Numbers a cell that are recorded of a step: positions and velocities of both masses and friction; with 6 the
    normal force, which is otherwise what presses; with 7 the gaps, which an internal state then holds."""

    def __init__(self, lane: Lane, kernel: Callable[..., None] | None = None, numbers: tuple[Any, ...] = ()):
        chain = lane.chain
        self.lane, self._kernel, self._given = lane, kernel, numbers
        self._force = -np.hstack([chain.stiffness_matrix, chain.damping_matrix])
        self._masses = np.concatenate([chain.outer_mass, chain.inner_mass])

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state` at step index `start`."""
        lane, cells = self.lane, self.lane.chain.cells
        record = np.empty((steps, self.columns * cells))
        end = self._integrate(state, start, steps, record)
        position, velocity, friction, normal, gap = np.split(record, np.array([2, 4, 5, 6]) * cells, axis=1)
        pressed = normal if normal.size else lane.preloads(start, steps)
        internal_state = None if end.internal_state is None else end.internal_state[0]
        gaps = gap if gap.size and internal_state is not None else None
        return Trajectory(lane.times(start, steps), position, velocity, friction, pressed, internal_state, gaps)

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance as `run` does, and keep the end only."""
        return self._integrate(state, start, steps, np.empty((0, self.columns * self.lane.chain.cells)))

    def _integrate(self, state: State, start: int, steps: int, record: FloatArray) -> State:
        """Take the steps, write a row of each into `record` unless it has none, and give the end."""
        motion = np.concatenate([state.positions[0], state.velocities[0]])
        self._take(motion, self.lane.loads(start, steps), self._bounds(start, steps), record)
        position, velocity = np.split(motion[None], 2, axis=1)
        return State(position, velocity)

    def _take(self, motion: FloatArray, loads: FloatArray, bounds: FloatArray, record: FloatArray) -> None:
        """Take a step for each load; a model with an internal state overrides `_integrate` instead.

        `motion`, shape (4n,), are positions and velocities, which become those of the end; `loads`, shape (steps,), the
        force on cell 1, and `bounds`, shape (steps, n), what `_bounds` gives. `record`, shape (steps, 5n), gets
        positions, velocities and friction of each step; it may have no rows.
        """
        assert self._kernel is not None, "a model without one overrides what calls it"
        self._kernel(motion, loads, bounds, self._force, self._masses, self._given, record)

    def _bounds(self, start: int, steps: int) -> FloatArray:
        """Give μ λ_N of every contact in each step, shape (steps, n)."""
        return np.ascontiguousarray(self.lane.chain.friction_coefficient * self.lane.preloads(start, steps))
