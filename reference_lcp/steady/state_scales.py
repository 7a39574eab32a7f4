"""States of a batch of lanes as non-dimensional vectors."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.validation import FloatArray


class StateScales:
    """Non-dimensional vectors of states: positions over s, velocities over s ω, internal state over its own size.

    The size of internal state is learnt, since only its law knows what it is: |z_0| + Σ |z(t + T) − z(t)| over the
    periods so far, with z_0 that of the start. So far have periods taken it; the largest value that a search has tried
    would let a law that drifts for ever repeat, once it has been extrapolated far enough. Values of one kind, one a
    contact, share the largest of their sizes, so that a contact that hardly moves is not measured by its round-off;
    what has been zero so far is taken as it is. Gaps and their rates, where contacts open, are lengths and velocities:
    s and s ω.

    Parameters
    ----------
    lanes
        At least one; s is the displacement scale of its drive.
    steps_per_period
        Steps of one period of the drive, whose angular frequency is ω.
    """

    def __init__(self, lanes: Sequence[Lane], steps_per_period: int):
        lengths = np.array([lane.drive.displacement_scale(lane.chain) for lane in lanes])
        frequencies = np.array([2 * np.pi / (steps_per_period * lane.time_step) for lane in lanes])
        self._cells = lanes[0].chain.cells
        self._opens = np.array([lane.opens for lane in lanes])
        width = 2 * self._cells
        self._scale = np.hstack(
            [np.repeat(lengths[:, None], width, axis=1), np.repeat((lengths * frequencies)[:, None], width, axis=1)]
        )
        self._sizes = np.zeros((len(lanes), 0))

    def learn(self, start: State | None, end: State, lanes: Any) -> FloatArray:
        """Let the sizes of internal state grow by what a period from `start` to `end` has changed.

        Internal state that the start does not have counts as zero; so does that of no start at all.

        Returns
        -------
        ndarray
            By what earlier vectors of these lanes, internal state that has just appeared included as zeros, have to be
            multiplied, shape (lanes, 4n + k).
        """
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
        factor: FloatArray = before / self._scales(lanes)
        return factor

    def vectors(self, state: State, lanes: Any) -> FloatArray:
        """Vectors (lanes, 4n + k) of the states of these lanes; k = 0 before internal state has been learnt.

        Lanes without internal state among others with one have zeros, as in `State.stack`.
        """
        internal_state = (
            np.zeros((len(lanes), self._sizes.shape[1])) if state.internal_state is None else state.internal_state
        )
        vectors: FloatArray = np.hstack([state.positions, state.velocities, internal_state]) / self._scales(lanes)
        return vectors

    def state(self, vectors: FloatArray, lanes: Any) -> State:
        """States of these lanes from their vectors; those of 4n components have no internal state: a fresh start."""
        half = 2 * self._cells
        values = vectors * self._scales(lanes)[:, : vectors.shape[1]]
        internal_state = values[:, 2 * half :] if vectors.shape[1] > 2 * half else None
        return State(values[:, :half], values[:, half : 2 * half], internal_state)

    def residuals(self, starts: FloatArray, changes: FloatArray) -> FloatArray:
        """Largest change of each vector (lanes, 4n + k), not below what is resolved of internal state: shape (lanes,).

        A law that drifts for ever has no fixed point, and mixing extrapolates it to where a period's change is lost in
        round-off. That counts as unresolved, by a residual of up to one, and not as repeated.
        """
        largest: FloatArray = np.max(np.abs(changes), axis=1)
        internal = starts[:, 4 * self._cells :]
        if internal.shape[1] == 0:
            return largest
        return np.maximum(largest, np.minimum(np.finfo(float).eps * np.max(np.abs(internal), axis=1), 1.0))

    def subset(self, lanes: Any) -> "StateScales":
        """Give the scales of the lanes of these indices."""
        part = StateScales.__new__(StateScales)
        part._cells, part._opens = self._cells, self._opens[lanes]
        part._scale, part._sizes = self._scale[lanes], self._sizes[lanes]
        return part

    def _scales(self, lanes: Any) -> FloatArray:
        """What the components of these lanes are divided by."""
        motion, sizes = self._scale[lanes], self._sizes[lanes]
        if sizes.shape[1] == 0:
            return motion
        sizes = np.where(sizes > 0, sizes, 1.0)
        n = self._cells
        if sizes.shape[1] == 2 * n and np.any(self._opens[lanes]):
            across = np.hstack([motion[:, :n], motion[:, -n:]])
            sizes = np.where(self._opens[lanes][:, None], across, sizes)
        return np.hstack([motion, sizes])

    def _largest_of_kind(self, values: FloatArray) -> FloatArray:
        """Largest of the values of each kind, one a contact; each its own kind where k is no multiple of n."""
        lanes, k = values.shape
        if k % self._cells:
            return values
        largest = values.reshape(lanes, -1, self._cells).max(axis=2)
        return np.repeat(largest, self._cells, axis=1)
