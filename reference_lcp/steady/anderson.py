"""Anderson acceleration: fixed points of the map that takes the state of a chain from one period to the next.

Mixing the last iterates (Anderson 1965, in the form of Walker and Ni 2011) needs nothing of an engine but to set and to
read states. As long as contacts neither stick anew nor slip anew the map is affine, and mixing is a Krylov method
(GMRES): it ends once as many differences are kept as the state has dimensions. Where they do, older differences belong
to another map: one that lies nearly in the span of newer ones is left out (Pollock and Rebholz 2023).
"""

from collections.abc import Sequence
from functools import partial
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.chain.trajectory import State
from reference_lcp.validation import FloatArray
from reference_lcp.watching import tell

SEARCH = "search for the steady state"
"""What is told to whoever watches."""

FEWEST_KEPT = 20
"""Differences kept by the acceleration at least, for chains of few cells."""

KEPT_PER_CELL = 6
"""Differences kept for each cell, whose state has four dimensions: half as many again, since some drop out."""

MOST_KEPT = 400
"""Differences kept at most: a usual search is over by then, and a thousand cells take 26 MB a lane."""

WARM_UP_PERIODS = 6
"""Plain periods before the first mixing."""

DEPENDENT = 0.1
"""A difference is left out whose part outside the span of newer ones is a smaller part of it than this."""

CANCELLED = 0.7
"""A difference of which less is left is made orthogonal once more: about 1/√2, as Daniel et al. advise."""

SHORTEST_PATIENCE = 25
"""Periods without a better residual, at least, after which a lane starts again from its best iterate.

Mixing can be caught where contacts change between stick and slip from one iterate to the next. The history is then
dropped, and plain periods, at every new start half as many again, lead out of the place.
"""

PATIENCE_PER_CELL = 5
"""The same for each cell: a Krylov method may stand still until it has as many differences as dimensions, 4 a cell.

The patience lasts for these at least, after the plain periods and the first of them.
"""

HOPELESS = 4
"""Times the patience in which a search has to halve its best residual, or it is given up."""

LARGEST_RISE = 1e3
"""Residual over the best one beyond which a lane starts again from its best iterate at once: it has mixed noise."""

VECTORS = 32
"""Numbers that a compiled loop takes at once; vectors that are shorter by a few have zeros at their end."""

LARGEST_RESIDUAL = 1e6
"""Residual, in displacement scales, beyond which a motion counts as diverged."""

_called = partial(numba.njit, cache=True, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
"""Compiled for compiled callers alone."""


class StateScales:
    """Non-dimensional vectors of states: positions over s, velocities over s ω, internal state over its own size.

    The size of internal state is learnt, since only its law knows what it is: |z_0| + Σ |z(t + T) − z(t)| over the
    periods so far. The largest value that a search has tried would let a law that drifts for ever repeat. Values of one
    kind, one a contact, share the largest of their sizes, so that a contact that hardly moves is not measured by its
    round-off. Gaps and their rates, where contacts open, are over s and s ω.
    """

    def __init__(self, lanes: Sequence[Lane], steps_per_period: int):
        lengths = np.array([lane.drive.displacement_scale(lane.chain) for lane in lanes])
        frequencies = np.array([2 * np.pi / (steps_per_period * lane.time_step) for lane in lanes])
        self._width = width = lanes[0].chain.freedoms
        self._opens = np.array([lane.opens for lane in lanes])
        self._scale = np.hstack(
            [np.repeat(lengths[:, None], width, axis=1), np.repeat((lengths * frequencies)[:, None], width, axis=1)]
        )
        self._sizes = np.zeros((len(lanes), 0))

    def learn(self, start: State | None, end: State, lanes: Any) -> FloatArray:
        """Let sizes of internal state grow by a period's change; gives factors (lanes, 4n + k) of earlier vectors."""
        if end.internal_state is None:
            return np.ones((len(lanes), self._scale.shape[1] + self._sizes.shape[1]))
        if self._sizes.shape[1] == 0:
            self._sizes = np.zeros((self._scale.shape[0], end.internal_state.shape[1]))
        before = self._scales(lanes)
        change = np.abs(
            end.internal_state
            if start is None or start.internal_state is None
            else end.internal_state - start.internal_state
        )
        self._sizes[lanes] += self._largest_of_kind(np.where(np.isfinite(change), change, 0.0))
        return before / self._scales(lanes)

    def vectors(self, state: State, lanes: Any) -> FloatArray:
        """Vectors (lanes, 4n + k) of the states of these lanes; k = 0 before internal state has been learnt."""
        internal_state = (
            np.zeros((len(lanes), self._sizes.shape[1])) if state.internal_state is None else state.internal_state
        )
        return np.hstack([state.positions, state.velocities, internal_state]) / self._scales(lanes)

    def state(self, vectors: FloatArray, lanes: Any) -> State:
        """States of these lanes from their vectors; those of 4n components have no internal state: a fresh start."""
        half = self._width
        values = vectors * self._scales(lanes)[:, : vectors.shape[1]]
        internal_state = values[:, 2 * half :] if vectors.shape[1] > 2 * half else None
        return State(values[:, :half], values[:, half : 2 * half], internal_state)

    def residuals(self, starts: FloatArray, changes: FloatArray) -> FloatArray:
        """Largest change of each vector (lanes, 4n + k), at least what internal state resolves, shape (lanes,)."""
        largest: FloatArray = np.max(np.abs(changes), axis=1)
        internal = starts[:, 2 * self._width :]
        if internal.shape[1] == 0:
            return largest
        return np.maximum(largest, np.minimum(np.finfo(float).eps * np.max(np.abs(internal), axis=1), 1.0))

    def subset(self, lanes: Any) -> "StateScales":
        """Give the scales of the lanes of these indices."""
        part = StateScales.__new__(StateScales)
        part._width, part._opens = self._width, self._opens[lanes]
        part._scale, part._sizes = self._scale[lanes], self._sizes[lanes]
        return part

    def _scales(self, lanes: Any) -> FloatArray:
        motion, sizes = self._scale[lanes], self._sizes[lanes]
        if sizes.shape[1] == 0:
            return motion
        sizes = np.where(sizes > 0, sizes, 1.0)
        n = self._width // 2
        if sizes.shape[1] == 2 * n and np.any(self._opens[lanes]):
            across = np.hstack([motion[:, :n], motion[:, -n:]])
            sizes = np.where(self._opens[lanes][:, None], across, sizes)
        return np.hstack([motion, sizes])

    def _largest_of_kind(self, values: FloatArray) -> FloatArray:
        """Largest of the values of each kind, one a contact; each its own kind where k is no multiple of n."""
        (lanes, k), n = values.shape, self._width // 2
        if k % n:
            return values
        largest = values.reshape(lanes, -1, n).max(axis=2)
        return np.repeat(largest, n, axis=1)


@_called(fastmath={"reassoc", "contract"})
def _dot(a: Any, b: Any) -> float:
    """Scalar product; written out, since vectors this short cost less than a call of BLAS."""
    total = 0.0
    for k in range(a.shape[0]):
        total += a[k] * b[k]
    return total


@_called()
def _subtract(factor: float, a: Any, b: Any) -> None:
    for k in range(a.shape[0]):
        b[k] -= factor * a[k]


@_called()
def _orthogonalised(q: Any, used: int, r: Any) -> float:
    """Take the span of the first rows of `q` from the row after them, in place; gives what is left of its norm."""
    direction = q[used]
    left = np.sqrt(_dot(direction, direction))
    overlaps = r[-1]
    for j in range(used):
        r[used, j] = 0.0
    for _ in range(2):
        before = left
        for j in range(used):
            overlaps[j] = _dot(q[j], direction)
        for j in range(used):
            _subtract(overlaps[j], q[j], direction)
            r[used, j] += overlaps[j]
        left = np.sqrt(_dot(direction, direction))
        if left > CANCELLED * before:
            break
    return left


@_called()
def _solve_triangular(r: Any, weights: Any) -> None:
    """Solve Rᵀ γ = w for γ, in place of the weights w; R is the lower triangle of `r`."""
    for j in range(weights.shape[0] - 1, -1, -1):
        weights[j] /= r[j, j]
        _subtract(weights[j], r[j, :j], weights[:j])


@_called()
def _mixed(x: Any, f: Any, newest: int, kept: int, q: Any, g: Any, r: Any, following: Any) -> None:
    """Next iterate from the history of one lane, into `following`.

    `x` and `f` are rings (rows, d) of iterates and of their residuals g(x) − x, of which `kept` before the `newest` are
    used. The differences of f are made orthogonal, newest first; dependent ones (cells that stay stuck) drop out. `q`,
    `g` and `r` are room for the orthogonal differences, those of g(x), and the triangle between the two.
    """
    rows, d = x.shape
    used, weights, rest = np.int64(0), np.empty(kept), np.zeros(q.shape[1])
    for k in range(d):
        rest[k] = f[newest, k]
    for back in range(kept):
        later, earlier = (newest - back) % rows, (newest - back - 1) % rows
        for k in range(d):
            q[used, k] = f[later, k] - f[earlier, k]
            g[used, k] = q[used, k] + (x[later, k] - x[earlier, k])
        size = np.sqrt(_dot(q[used], q[used]))
        left = _orthogonalised(q, used, r)
        if left > DEPENDENT * size and left > 0.0:
            for k in range(d):
                q[used, k] /= left
            r[used, used] = left
            weights[used] = _dot(q[used], rest)
            _subtract(weights[used], q[used], rest)
            used += 1
    _solve_triangular(r, weights[:used])
    for k in range(d):
        following[k] = x[newest, k] + f[newest, k]
    for j in range(used):
        _subtract(weights[j], g[j], following)


@numba.njit(cache=True, error_model="numpy")
def _mixed_lanes(x: Any, f: Any, lanes: Any, newest: int, kept: Any) -> Any:
    """`_mixed` for the listed lanes of the histories (lanes, rows, d), each with its own `kept`."""
    _, rows, d = x.shape
    q = np.zeros((rows, -(-d // VECTORS) * VECTORS))
    g, r = np.empty((rows, d)), np.empty((rows + 1, rows))
    following = np.empty((lanes.shape[0], d))
    for k in range(lanes.shape[0]):
        _mixed(x[lanes[k]], f[lanes[k]], newest, kept[lanes[k]], q, g, r, following[k])
    return following


def _widened(vectors: FloatArray, factor: FloatArray) -> FloatArray:
    """Vectors (lanes, d) or histories of them (lanes, rows, d), with zeros up to the width of `factor`, times it."""
    missing = factor.shape[1] - vectors.shape[-1]
    wide = np.concatenate([vectors, np.zeros((*vectors.shape[:-1], missing))], axis=-1) if missing else vectors
    return wide * factor.reshape(factor.shape[0], *[1] * (vectors.ndim - 2), -1)


class FixedPointSearch:
    """The search for a fixed point of the map x(t) → x(t + k Δt), lane by lane, each until it converges or diverges.

    `newton`, shape (lanes, 4n, 4n), says of a residual the way to the fixed point, where it is known from a map near to
    this one: what is mixed are Newton's steps, without plain periods before. The residual itself without it.
    """

    def __init__(
        self,
        simulation: Simulation,
        scales: StateScales,
        steps: int,
        tolerance: float,
        newton: FloatArray | None = None,
    ):
        self._simulation = simulation
        self._newton = newton
        self._steps = steps
        self._tolerance = tolerance
        self._scales = scales
        cells = simulation.lanes[0].chain.freedoms // 2
        count, width = len(simulation.lanes), 2 * simulation.lanes[0].chain.freedoms
        self._most_differences = differences = min(max(FEWEST_KEPT, KEPT_PER_CELL * cells), MOST_KEPT)
        self._patience = max(SHORTEST_PATIENCE, PATIENCE_PER_CELL * cells, WARM_UP_PERIODS + width + 1)
        self._x = np.zeros((count, differences + 1, width))
        self._f = np.zeros((count, differences + 1, width))
        self._age = np.zeros(count, dtype=int)
        self._plain = np.full(count, WARM_UP_PERIODS if newton is None else 1)
        self._plain_next = np.full(count, WARM_UP_PERIODS)
        self._stalled = np.zeros(count, dtype=int)
        self._halved = np.full(count, np.inf)
        self._since_halved = np.zeros(count, dtype=int)
        self.best = np.zeros((count, width))
        self._best_change = np.zeros((count, width))
        self.best_residual = np.full(count, np.inf)
        self.periods = np.zeros(count, dtype=int)
        self._last_residual = np.full(count, np.inf)
        self._active = np.arange(count)
        self._part = simulation

    def run(self, start: State, periods: int) -> None:
        """Apply the map until every lane has converged or diverged, at most `periods` times."""
        self._learn(None, start)
        following = self._scales.vectors(start, self._active)
        for period in range(periods):
            row = period % (self._most_differences + 1)
            state = self._scales.state(following, self._active)
            end = self._part.advance(state, 0, self._steps)
            if end.internal_state is not None:
                following = _widened(following, self._learn(state, end))
            change = self._scales.vectors(end, self._active) - following
            f = self._step(change)
            self._x[self._active, row], self._f[self._active, row] = following, f
            stays = self._note(following, f, self._scales.residuals(following, change))
            tell(SEARCH, period + 1, periods)
            if not np.any(stays):
                return
            if not np.all(stays):
                self._active = self._active[stays]
                self._part = self._simulation.subset(self._active)
            following = self._following(row)

    def _step(self, change: FloatArray) -> FloatArray:
        """What is added to each active lane's iterate where nothing is mixed: a period's change, or Newton's step."""
        if self._newton is None:
            return change
        width = self._newton.shape[1]
        motion = np.matmul(self._newton[self._active], change[:, :width, None])[:, :, 0]
        return np.hstack([motion, change[:, width:]])

    def _learn(self, start: State | None, end: State) -> FloatArray:
        """Let the sizes of internal state grow, and the history follow; gives the factors of earlier vectors."""
        factor = self._scales.learn(start, end, self._active)
        if factor.shape[1] > self.best.shape[1]:
            # a start without internal state is recorded with zeros: the residual of such a period is one
            every = np.ones((self.best.shape[0], factor.shape[1]))
            self._x, self._f = _widened(self._x, every), _widened(self._f, every)
            self.best, self._best_change = _widened(self.best, every), _widened(self._best_change, every)
        if np.any(factor != 1):
            for history in (self._x, self._f):
                history[self._active] *= factor[:, None]
            for best in (self.best, self._best_change):
                best[self._active] *= factor
        return factor

    def _following(self, row: int) -> FloatArray:
        """Next iterate of every active lane: mixed, plain, or from the best one again."""
        lanes = self._active
        rise = self._last_residual[lanes] > LARGEST_RISE * self.best_residual[lanes]
        caught = lanes[(self._stalled[lanes] >= self._patience) | (rise & (self._age[lanes] >= self._plain[lanes]))]
        self._x[caught, row] = self.best[caught]
        self._f[caught, row] = self._best_change[caught]
        self._age[caught], self._stalled[caught] = 0, 0
        self._plain[caught] = self._plain_next[caught]
        self._plain_next[caught] += self._plain_next[caught] // 2
        kept = np.clip(self._age - self._plain + 1, 0, self._most_differences)
        self._age[self._active] += 1
        return _mixed_lanes(self._x, self._f, self._active, row, kept)

    def _note(self, x: FloatArray, f: FloatArray, residual: FloatArray) -> Any:
        """Store the best iterate of each active lane; give which lanes go on."""
        self._last_residual[self._active] = residual
        self.periods[self._active] += 1
        self._stalled[self._active] += 1
        better = residual < self.best_residual[self._active]
        lanes = self._active[better]
        self.best[lanes], self.best_residual[lanes] = x[better], residual[better]
        self._best_change[lanes], self._stalled[lanes] = f[better], 0
        self._since_halved[self._active] += 1
        halved = self._active[residual < self._halved[self._active] / 2]
        self._halved[halved], self._since_halved[halved] = self.best_residual[halved], 0
        hopeful = self._since_halved[self._active] < HOPELESS * self._patience
        return (residual > self._tolerance) & (residual < LARGEST_RESIDUAL) & hopeful

    def starts(self, lanes: Sequence[int] | NDArray[np.intp]) -> State:
        """Best start of a period that was found for each of these lanes."""
        return self._scales.state(self.best[lanes], lanes)

    def residuals(self, starts: State, ends: State) -> FloatArray:
        """Residual of a recorded period of every lane, or of the period in which the search lost the lane."""
        lanes = np.arange(len(self.periods))
        x = self._scales.vectors(starts, lanes)
        recorded = self._scales.residuals(x, self._scales.vectors(ends, lanes) - x)
        return np.where(self._last_residual < LARGEST_RESIDUAL, recorded, self._last_residual)
