"""Periodic orbits: the fixed point of the period map, found by Anderson acceleration.

A lightly damped chain needs thousands of periods to settle. The map x(t) → x(t + T) has the steady
state as its fixed point; mixing the last iterates (Anderson 1965, in the form of Walker and Ni 2011)
finds it in some thirty periods, with nothing asked of an engine but to set and to read positions
and velocities. The residual of one plain period certifies what was found.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numba
import numpy as np

from reference_lcp.simulation import Lane, Simulation
from reference_lcp.trajectory import State, Trajectory
from reference_lcp.validation import FloatArray, ParameterError, checked_count, checked_scalar

DEFAULT_RESIDUAL = 1e-8
"""Periodicity residual at which an orbit counts as found."""

DEFAULT_MEMORY = 20
"""Differences kept by the acceleration; 10 needs half as many periods again on figure 3."""

WARM_UP_PERIODS = 6
"""Plain periods before the first mixing: they leave the transient of the start behind."""

DEFAULT_PERIODS = 400
"""Periods after which the search gives up."""

DEPENDENT = 1e-6
"""A difference whose part outside the span of newer ones is smaller than this is left out."""

PATIENCE = 25
"""Periods without a better residual after which a lane starts again from its best iterate.

Mixing can be caught where contacts change between stick and slip from one iterate to the next. The
history is then dropped, and plain periods, at every new start half as many again, lead out of the
place. Of 500 random starts at the ten hardest points of figure 3 all converge so.
"""

DIVERGED = 1e6
"""Residual, in displacement scales, beyond which a motion counts as diverged."""


class OrbitStatus(StrEnum):
    """How the search for a periodic orbit ended."""

    CONVERGED = "converged"
    PERIOD_LIMIT = "period limit"
    DIVERGED = "diverged"


@dataclass(frozen=True)
class PeriodicOrbit:
    """One period of the steady state of one lane.

    Parameters
    ----------
    lane
        The chain, its drive and the time step.
    trajectory
        One period, one row a step, starting at phase zero of the drive.
    residual
        max(|Δ position| / s, |Δ velocity| / (s ω)) over one plain period, with s the displacement
        scale of the drive and ω its angular frequency.
    periods
        Periods that were simulated to find it, the certifying one included.
    status
        Whether the residual that was asked for has been reached.
    """

    lane: Lane
    trajectory: Trajectory
    residual: float
    periods: int
    status: OrbitStatus

    @property
    def converged(self) -> bool:
        """Whether the residual that was asked for has been reached."""
        return self.status is OrbitStatus.CONVERGED


@numba.njit(cache=True, error_model="numpy")
def _mixed(x: Any, f: Any, newest: int, kept: int) -> Any:
    """Next iterate from the history of one lane.

    `x` and `f` are rings (rows, d) of iterates and of their residuals g(x) − x; `newest` is the row
    of the last one and `kept` the number of older rows to use. The differences of f are made
    orthogonal, newest first, and those of g take part in the same operations: then the iterate
    needs no triangular solve, and dependent differences (cells that stay stuck) simply drop out.
    """
    rows, d = x.shape
    q = np.empty((kept, d))
    p = np.empty((kept, d))
    used = 0
    rest = f[newest].copy()
    following = x[newest] + rest
    for back in range(kept):
        later = (newest - back) % rows
        earlier = (newest - back - 1) % rows
        direction = f[later] - f[earlier]
        partner = direction + x[later] - x[earlier]
        size = np.sqrt(np.dot(direction, direction))
        for _ in range(2):
            for j in range(used):
                overlap = np.dot(q[j], direction)
                direction -= overlap * q[j]
                partner -= overlap * p[j]
        left = np.sqrt(np.dot(direction, direction))
        if left > DEPENDENT * size and left > 0.0:
            q[used] = direction / left
            p[used] = partner / left
            weight = np.dot(q[used], rest)
            rest -= weight * q[used]
            following -= weight * p[used]
            used += 1
    return following


@numba.njit(cache=True, error_model="numpy")
def _mixed_lanes(x: Any, f: Any, lanes: Any, newest: int, kept: Any) -> Any:
    """`_mixed` for the listed lanes of the histories (lanes, rows, d), each with its own `kept`."""
    following = np.empty((lanes.shape[0], x.shape[2]))
    for k in range(lanes.shape[0]):
        following[k] = _mixed(x[lanes[k]], f[lanes[k]], newest, kept[lanes[k]])
    return following


class _Scales:
    """Non-dimensional vectors of states: positions over s, velocities over s ω."""

    def __init__(self, lanes: Sequence[Lane], steps_per_period: int):
        lengths = np.array([lane.drive.displacement_scale(lane.chain) for lane in lanes])
        frequencies = np.array([2 * np.pi / (steps_per_period * lane.time_step) for lane in lanes])
        width = 2 * lanes[0].chain.cells
        self._scale = np.hstack(
            [np.repeat(lengths[:, None], width, axis=1), np.repeat((lengths * frequencies)[:, None], width, axis=1)]
        )

    def vectors(self, state: State, lanes: Any) -> FloatArray:
        """Vectors (lanes, 4n) of the states of these lanes."""
        vectors: FloatArray = np.hstack([state.positions, state.velocities]) / self._scale[lanes]
        return vectors

    def state(self, vectors: FloatArray, lanes: Any, memory: FloatArray | None) -> State:
        """States of these lanes from their vectors."""
        positions, velocities = np.hsplit(vectors * self._scale[lanes], 2)
        return State(positions, velocities, memory)


class _Search:
    """The state of the search, lane by lane; lanes leave when they converge or diverge."""

    def __init__(self, simulation: Simulation, steps_per_period: int, memory: int, tolerance: float):
        self._simulation = simulation
        self._steps = steps_per_period
        self._memory = memory
        self._tolerance = tolerance
        self._scales = _Scales(simulation.lanes, steps_per_period)
        count, width = len(simulation.lanes), 4 * simulation.lanes[0].chain.cells
        self._x = np.zeros((count, memory + 1, width))
        self._f = np.zeros((count, memory + 1, width))
        self._age = np.zeros(count, dtype=int)
        self._plain = np.full(count, WARM_UP_PERIODS)
        self._plain_next = np.full(count, WARM_UP_PERIODS)
        self._stalled = np.zeros(count, dtype=int)
        self.best = np.zeros((count, width))
        self._best_change = np.zeros((count, width))
        self.best_residual = np.full(count, np.inf)
        self.periods = np.zeros(count, dtype=int)
        self._last_residual = np.full(count, np.inf)
        self.friction_memory: list[FloatArray | None] = [None] * count
        self._active = np.arange(count)
        self._part = simulation

    def run(self, start: State, periods: int) -> None:
        """Iterate until every lane has converged or diverged, or `periods` are over."""
        following = self._scales.vectors(start, self._active)
        internal = start.memory
        for period in range(periods):
            row = period % (self._memory + 1)
            end = self._part.advance(self._scales.state(following, self._active, internal), 0, self._steps)
            f = self._scales.vectors(end, self._active) - following
            self._x[self._active, row], self._f[self._active, row] = following, f
            stays = self._note(following, f, internal)
            internal = None if end.memory is None else end.memory[stays]
            self._keep(stays)
            if self._active.size == 0:
                return
            following = self._following(row)

    def _following(self, row: int) -> FloatArray:
        """Next iterate of every active lane: mixed, plain, or from the best one again."""
        caught = self._active[self._stalled[self._active] >= PATIENCE]
        self._x[caught, row] = self.best[caught]
        self._f[caught, row] = self._best_change[caught]
        self._age[caught], self._stalled[caught] = 0, 0
        self._plain[caught] = self._plain_next[caught]
        self._plain_next[caught] += self._plain_next[caught] // 2
        kept = np.clip(self._age - self._plain + 1, 0, self._memory)
        self._age[self._active] += 1
        mixed: FloatArray = _mixed_lanes(self._x, self._f, self._active, row, kept)
        return mixed

    def _note(self, x: FloatArray, f: FloatArray, internal: FloatArray | None) -> Any:
        """Remember the best iterate of each active lane; say which lanes go on."""
        residual = np.max(np.abs(f), axis=1)
        self._last_residual[self._active] = residual
        self.periods[self._active] += 1
        self._stalled[self._active] += 1
        better = residual < self.best_residual[self._active]
        lanes = self._active[better]
        self.best[lanes], self.best_residual[lanes] = x[better], residual[better]
        self._best_change[lanes], self._stalled[lanes] = f[better], 0
        if internal is not None:
            for lane, row in zip(lanes, internal[better], strict=True):
                self.friction_memory[lane] = row
        return (residual > self._tolerance) & (residual < DIVERGED)

    def _keep(self, stays: Any) -> None:
        """Leave the lanes that are done out of what is simulated next."""
        if np.all(stays):
            return
        self._active = self._active[stays]
        if self._active.size:
            self._part = self._simulation.subset(self._active)

    def start_of(self, lane: int) -> State:
        """Best start of a period that was found for a lane."""
        internal = self.friction_memory[lane]
        memory = None if internal is None else internal[None, :]
        return self._scales.state(self.best[[lane]], [lane], memory)

    def residual(self, lane: int, start: State, trajectory: Trajectory) -> float:
        """Residual of a recorded period, or of the period in which the search lost the lane."""
        change = self._scales.vectors(trajectory.end, [lane]) - self._scales.vectors(start, [lane])
        lost = self._last_residual[lane]
        return float(np.max(np.abs(change))) if lost < DIVERGED else float(lost)

    def status(self, residual: float) -> OrbitStatus:
        """What a residual means."""
        if residual <= self._tolerance:
            return OrbitStatus.CONVERGED
        return OrbitStatus.PERIOD_LIMIT if residual < DIVERGED else OrbitStatus.DIVERGED


def periodic_orbits(
    simulation: Simulation,
    steps_per_period: int,
    *,
    start: State | None = None,
    tolerance: float = DEFAULT_RESIDUAL,
    memory: int = DEFAULT_MEMORY,
    max_periods: int = DEFAULT_PERIODS,
) -> list[PeriodicOrbit]:
    """Find the periodic orbit of every lane of a simulation.

    Coulomb friction with a given normal force is monotone: the energy norm of the difference of two
    motions under the same drive never grows. A fixed point of the period map is therefore the
    attractor, unique up to the offsets of cells that stay stuck.

    Parameters
    ----------
    simulation
        The lanes; each has a time step of its drive's period over `steps_per_period`.
    steps_per_period
        Number of steps that make one period.
    start
        State from which the search starts; at rest without it.
    tolerance
        Residual that is asked for, see `PeriodicOrbit.residual`.
    memory
        Number of differences that are mixed.
    max_periods
        Periods after which the search gives up; the best orbit found is then returned.

    Returns
    -------
    list of PeriodicOrbit
        One a lane, in order. Orbits that did not converge say so in their status.

    Raises
    ------
    ParameterError
        If a number is outside its range, a lane's time step does not divide its drive's period, or that is no
        period of its preload.
    """
    checked_scalar("tolerance", tolerance, "> 0")
    checked_count("memory", memory)
    checked_count("max_periods", max_periods)
    for lane in simulation.lanes:
        _check_period(lane, steps_per_period)
    search = _Search(simulation, steps_per_period, memory, tolerance)
    cells = simulation.lanes[0].chain.cells
    search.run(start if start is not None else State.at_rest(len(simulation.lanes), cells), max_periods)
    return _certified(simulation, search, steps_per_period)


def _certified(simulation: Simulation, search: _Search, steps_per_period: int) -> list[PeriodicOrbit]:
    """Record one plain period from the best start of each lane, and take its residual."""
    starts = [search.start_of(lane) for lane in range(len(simulation.lanes))]
    trajectories = simulation.run(State.stack(starts), 0, steps_per_period)
    orbits = []
    for lane, trajectory in enumerate(trajectories):
        residual = search.residual(lane, starts[lane], trajectory)
        periods = int(search.periods[lane]) + 1
        orbits.append(PeriodicOrbit(simulation.lanes[lane], trajectory, residual, periods, search.status(residual)))
    return orbits


def _check_period(lane: Lane, steps_per_period: int) -> None:
    """Refuse a lane whose steps do not make up a period of its drive."""
    checked_count("steps_per_period", steps_per_period, 3)
    period = getattr(lane.drive, "period", None)
    if period is None:
        raise ParameterError(f"{type(lane.drive).__name__} has no period; allowed: a periodic drive")
    if not np.isclose(lane.time_step * steps_per_period, period, rtol=1e-12, atol=0):
        steps = period / lane.time_step
        raise ParameterError(f"the time step makes {steps:g} steps a period; allowed: {steps_per_period}")
    if lane.preload is not None:
        multiple = lane.preload.angular_frequency * period / (2 * np.pi)
        if not np.isclose(multiple, max(1, round(multiple)), rtol=1e-12, atol=0):
            raise ParameterError(f"the preload has {multiple:g} times the drive's frequency; allowed: whole multiples")
