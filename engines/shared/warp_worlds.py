"""Worlds in the memory of Warp that take their steps together, and the graph of their step."""

import functools
import importlib
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from multibody_xval.engines.shared.silence import silent_standard_error
from reference_lcp.validation import FloatArray

PROCESSOR = "cpu"
"""The device of all worlds, as Warp names it: results are the processor's alone."""


CHUNK = 128
"""Steps whose loads and records are held at once: some 40 MB for a thousand worlds of seven cells."""


class Rows(NamedTuple):
    """What is read of every step, shape (steps, worlds, ...), in the units of each world."""

    positions: FloatArray
    velocities: FloatArray
    friction: FloatArray
    normal_force: FloatArray


class WarpWorlds(ABC):
    """Worlds of one structure that take their steps together.

    A step is recorded once as a graph: launched kernel by kernel from Python it takes a hundred times as long. The
    graph holds no numbers of its own: it finds its loads, and where its record goes, by a counter of steps.
    """

    def __init__(self, size: int, cells: int):
        warp = import_warp()
        with warp.ScopedDevice(PROCESSOR):
            self._step = warp.zeros(1, dtype=int)
            self._loads = warp.zeros((CHUNK, size), dtype=float)
            self._pressing = warp.zeros((CHUNK, size, cells), dtype=float)
            self._values = self._allocate()
            self._record = [warp.zeros((CHUNK, *values.shape), dtype=float) for values in self._values]
        self.eager_step()  # compiles what this machine has not kept
        self.launch = recorded(self.eager_step)

    def set(self, positions: FloatArray, velocities: FloatArray) -> None:
        """Give every world a state in the engine's coordinates, shape (worlds, coordinates) each."""
        self._set(positions, velocities)
        no_forces = (np.zeros(values.shape) for values in self._values[2:])
        self._last = Rows(positions, velocities, *no_forces)

    def steps(self, loads: FloatArray, pressing: FloatArray) -> Rows:
        """Take a step for each row of loads, at most `CHUNK`.

        `loads`, shape (steps, worlds), are forces on cell 1; `pressing`, shape (steps, worlds, n), bounds friction: a
        force of friction in joints, a normal force in contacts.
        """
        self._loads[: len(loads)].assign(loads)
        self._pressing[: len(loads)].assign(pressing)
        self._step.zero_()
        for _ in range(len(loads)):
            self.launch()
        rows = Rows(*(record.numpy()[: len(loads)].astype(np.float64) for record in self._record))
        self._repeat_last_finite(rows)
        self._last = Rows(*(values[-1] for values in rows))
        return rows

    @abstractmethod
    def _allocate(self) -> Any:
        """Put models and states into Warp's memory; give the `Rows` of one step, arrays of shape (worlds, ...)."""

    @abstractmethod
    def _set(self, positions: FloatArray, velocities: FloatArray) -> None:
        """Put a state into every world, and forget what came before."""

    @abstractmethod
    def _set_forces(self) -> None:
        """Launch what takes the loads of this step to the engine."""

    @abstractmethod
    def _advance(self) -> None:
        """Launch one step of the engine alone."""

    def _read_forces(self) -> None:
        """Launch what takes forces of this step to where they are recorded from, where the engine has none there."""
        return

    def eager_step(self) -> None:
        """Load, take and record a step, kernel by kernel."""
        from multibody_xval.engines.shared import warp_kernels as kernels

        warp = import_warp()
        with warp.ScopedDevice(PROCESSOR):
            self._set_forces()
            self._advance()
            self._read_forces()
            for values, record in zip(self._values, self._record, strict=True):
                warp.launch(kernels.record, values.shape, [self._step, values, record])
            warp.launch(kernels.count, 1, [self._step])

    def _repeat_last_finite(self, rows: Rows) -> None:
        """Let a world that has diverged stay where its numbers were finite last."""
        finite = np.all([np.all(np.isfinite(values), axis=2) for values in rows], axis=0)
        for world in np.flatnonzero(~np.all(finite, axis=0)):
            first = int(np.argmin(finite[:, world]))
            for values, last in zip(rows, self._last, strict=True):
                values[first:, world] = values[first - 1, world] if first > 0 else last[world]


def recorded(step: Callable[[], object]) -> Callable[[], None]:
    """Record what a step launches as a graph; give the function that launches it again."""
    warp = import_warp()
    with warp.ScopedDevice(PROCESSOR), warp.ScopedCapture(PROCESSOR) as capture:
        step()
    return functools.partial(warp.capture_launch, capture.graph)


def recorded_after(eager: int, step: Callable[[], object]) -> Callable[[], None]:
    """Give what takes a step: as it is so many times, which loads kernels and finds memory, and then as a graph."""
    taken = 0

    def take() -> None:
        nonlocal taken, step
        if taken == eager:
            step = recorded(step)
        taken += 1
        step()

    return take


@functools.cache
def import_warp() -> Any:
    """Import Warp, which does not tell what it compiles, nor that there is no graphics card."""
    warp = importlib.import_module("warp")
    warp.config.log_level = warp.LOG_ERROR
    with silent_standard_error():
        warp.init()
    return warp
