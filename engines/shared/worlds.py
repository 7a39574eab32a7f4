"""Worlds that take their steps together, in engines that advance all lanes of a batch at once."""

from abc import ABC, abstractmethod
from typing import NamedTuple

import numpy as np

from reference_lcp.validation import FloatArray

CHUNK = 128
"""Steps whose loads and records are held at once: some 40 MB for a thousand worlds of seven cells."""


class Rows(NamedTuple):
    """What is read of every step, shape (steps, worlds, ...), in the units of each world."""

    positions: FloatArray
    velocities: FloatArray
    friction: FloatArray
    normal_force: FloatArray


class Worlds(ABC):
    """Worlds of one structure; adapters say how they take a state, and their steps."""

    def set(self, positions: FloatArray, velocities: FloatArray) -> None:
        """Give every world a state in the engine's coordinates, shape (worlds, coordinates) each."""
        self._set(positions, velocities)
        no_forces = (np.zeros((len(positions), columns)) for columns in self._force_columns)
        self._last = Rows(positions, velocities, *no_forces)

    def steps(self, loads: FloatArray, pressing: FloatArray) -> Rows:
        """Take a step for each row of loads, at most `CHUNK`.

        `loads`, shape (steps, worlds), are forces on cell 1; `pressing`, shape (steps, worlds, n), bounds friction: a
        force of friction in joints, a normal force in contacts.
        """
        rows = self._steps(loads, pressing)
        self._repeat_last_finite(rows)
        self._last = Rows(*(values[-1] for values in rows))
        return rows

    @property
    @abstractmethod
    def _force_columns(self) -> tuple[int, int]:
        """Numbers that are read of a world for friction, and for normal forces."""

    @abstractmethod
    def _set(self, positions: FloatArray, velocities: FloatArray) -> None:
        """Put a state into every world, and forget what came before."""

    @abstractmethod
    def _steps(self, loads: FloatArray, pressing: FloatArray) -> Rows:
        """Take the steps, and give what was recorded as arrays that may be written to."""

    def _repeat_last_finite(self, rows: Rows) -> None:
        """Let a world that has diverged stay where its numbers were finite last."""
        finite = np.all([np.all(np.isfinite(values), axis=2) for values in rows], axis=0)
        for world in np.flatnonzero(~np.all(finite, axis=0)):
            first = int(np.argmin(finite[:, world]))
            for values, last in zip(rows, self._last, strict=True):
                values[first:, world] = values[first - 1, world] if first > 0 else last[world]
