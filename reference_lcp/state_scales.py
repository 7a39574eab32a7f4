"""States of a batch of lanes as non-dimensional vectors."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from reference_lcp.simulation import Lane
from reference_lcp.trajectory import State
from reference_lcp.validation import FloatArray


class StateScales:
    """Non-dimensional vectors of states: positions over s, velocities over s ω.

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

    def subset(self, lanes: Any) -> "StateScales":
        """Give the scales of the lanes of these indices."""
        part = StateScales.__new__(StateScales)
        part._scale = self._scale[lanes]
        return part
