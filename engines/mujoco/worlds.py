"""Worlds that take their steps together: copies of MuJoCo that advance all lanes of a batch at once."""

from abc import ABC, abstractmethod
from typing import NamedTuple

import numpy as np

from reference_lcp.validation import FloatArray

CHUNK = 128
"""Steps whose loads and records are held at once: some 40 MB for a thousand worlds of seven cells."""


class Rows(NamedTuple):
    """What is read of every step, shape (steps, worlds, ...), in the units of each world."""

    qpos: FloatArray
    qvel: FloatArray
    qfrc_constraint: FloatArray
    sensordata: FloatArray


class Worlds(ABC):
    """Worlds of one structure; adapters say how they take a state, and their steps."""

    def set(self, qpos: FloatArray, qvel: FloatArray) -> None:
        """Give every world a state, shape (worlds, nq) each."""
        self._set(qpos, qvel)
        self._last = Rows(qpos, qvel, np.zeros(qpos.shape), np.zeros((len(qpos), self._sensors)))

    def steps(self, loads: FloatArray, bounds: FloatArray) -> Rows:
        """Take a step for each row of loads, at most `CHUNK`.

        Parameters
        ----------
        loads
            Control of each step and world, shape (steps, worlds).
        bounds
            Bound of friction in each step, world and cell, shape (steps, worlds, n); used where it is modulated.
        """
        rows = self._steps(loads, bounds)
        self._repeat_last_finite(rows)
        self._last = Rows(*(values[-1] for values in rows))
        return rows

    @abstractmethod
    def native_steps(self, steps: int) -> None:
        """Take steps of the engine alone, from where the worlds are."""

    @property
    @abstractmethod
    def _sensors(self) -> int:
        """Numbers that the sensors of a world give."""

    @abstractmethod
    def _set(self, qpos: FloatArray, qvel: FloatArray) -> None:
        """Put a state into every world."""

    @abstractmethod
    def _steps(self, loads: FloatArray, bounds: FloatArray) -> Rows:
        """Take the steps, and give what was recorded as arrays that may be written to."""

    def _repeat_last_finite(self, rows: Rows) -> None:
        """Let a world that has diverged stay where its numbers were finite last."""
        finite = np.all([np.all(np.isfinite(values), axis=2) for values in rows], axis=0)
        for world in np.flatnonzero(~np.all(finite, axis=0)):
            first = int(np.argmin(finite[:, world]))
            for values, last in zip(rows, self._last, strict=True):
                values[first:, world] = values[first - 1, world] if first > 0 else last[world]
