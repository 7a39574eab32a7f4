"""Lanes of one scene that take their steps together, under springs, dashpots and drives as forces of the adapter."""

import weakref
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from multibody_xval.engines.shared.coordinates import JointCoordinates
from multibody_xval.engines.shared.force_loop import LARGEST_MOTION
from multibody_xval.engines.shared.units import Units
from multibody_xval.engines.shared.worlds_simulation import LanesInUnits
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.validation import FloatArray, checked_count


class ForcedLanes(LanesInUnits, ABC):
    """Lanes of one scene, each in units of its own, under forces that are computed at the start of each step.

    A motion of all lanes, a row each, holds coordinates, then their velocities. The scene of an engine has
    ``set_motion(coordinates, velocities)``, ``step(forces)``, which gives the motion after it, and ``close()``.
    """

    def __init__(self, lanes: Sequence[Lane], units: Sequence[Units], coordinates: Sequence[JointCoordinates]):
        super().__init__(lanes, units)
        self._coordinates = tuple(coordinates)
        self._chains = [unit.scaled(lane.chain) for unit, lane in zip(units, lanes, strict=True)]
        both = list(zip(self._coordinates, self._chains, strict=True))
        self._forces = np.stack([own.force_matrix(chain) for own, chain in both])
        self._loaded = np.zeros(self._forces.shape[:2])
        for row, own in zip(self._loaded, self._coordinates, strict=True):
            row[own.loaded] = 1.0
        self._modulated = any(lane.preload is not None for lane in lanes)
        self._scene = self._new_scene()
        # Scenes may refer to themselves, and would wait for the collector of cycles.
        self._end = weakref.finalize(self, self._scene.close)

    @abstractmethod
    def _new_scene(self) -> Any:
        """Make the scene of all lanes."""

    @abstractmethod
    def _set_bounds(self, bounds: FloatArray) -> None:
        """Set the bounds of friction of the next step, shape (lanes, n), where they change in time."""

    @abstractmethod
    def _contacts(self, forces: FloatArray) -> FloatArray:
        """Read what the scene tells of contacts after a step under these forces, a row a lane."""

    @abstractmethod
    def _contact_forces(self, index: int, read: FloatArray, given: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Give friction and normal force [N] of a lane, of what was read, a row a step, and what presses contacts."""

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane; see `Simulation.run`.

        The last row of a lane that diverges is repeated.
        """
        motions: list[FloatArray] = []
        rows: list[FloatArray] = []
        for motion, forces, live in self._steps(state, start, steps):
            contacts = self._contacts(forces)
            if rows:
                contacts[~live] = rows[-1][~live]
            motions.append(motion)
            rows.append(contacts)
        return [
            self._trajectory(index, start, *(np.array([row[index] for row in each]) for each in (motions, rows)))
            for index in range(len(self.lanes))
        ]

    def _trajectory(self, index: int, start: int, motions: FloatArray, read: FloatArray) -> Trajectory:
        lane, end = self.lanes[index], self._state(index, motions)
        forces = self._contact_forces(index, read, lane.preloads(start, len(read)))
        return Trajectory(lane.times(start, len(read)), end.positions, end.velocities, *forces)

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance every lane, keep the final state; see `Simulation.advance`."""
        for motion, _, _ in self._steps(state, start, steps):
            end = motion
        return State.stack([self._state(index, end[index : index + 1]) for index in range(len(self.lanes))])

    def close(self) -> None:
        """Free the scene."""
        self._end()

    def _steps(
        self, state: State, start: int, steps: int
    ) -> Iterator[tuple[FloatArray, FloatArray, NDArray[np.bool_]]]:
        """Set the state, and take steps; gives the motions after each, the forces in it, and which lanes moved."""
        checked_count("steps", steps)
        state.check_fits(len(self.lanes), self.lanes[0].chain.cells)
        motion, live = self._motion(state), np.ones(len(self.lanes), dtype=np.bool_)
        self._scene.set_motion(*np.split(motion, 2, axis=1))
        bounds = self._bounds(start, steps) if self._modulated else ()
        for step, load in enumerate(self._loads(start, steps)):
            if self._modulated:
                self._set_bounds(bounds[step])
            forces = np.matmul(self._forces, motion[:, :, None])[:, :, 0] + load[:, None] * self._loaded
            forces[~live] = 0.0
            moved = self._scene.step(forces)
            # At numbers that are not finite, an engine may end the steps of all lanes.
            diverged = ~(np.max(np.abs(moved), axis=1) < LARGEST_MOTION)
            if diverged.any():
                live &= ~diverged
                resting = np.where(live[:, None], moved, 0.0)
                self._scene.set_motion(*np.split(resting, 2, axis=1))
            motion = np.where(live[:, None], moved, motion)
            yield motion, forces, live

    def _motion(self, state: State) -> FloatArray:
        """Give the motions of a state, each in the units of its lane."""
        position, velocity = state.positions / self._length, state.velocities / self._velocity
        return np.stack(
            [
                np.concatenate([own.of(position[index]), own.of(velocity[index])])
                for index, own in enumerate(self._coordinates)
            ]
        )

    def _state(self, index: int, motions: FloatArray) -> State:
        """Give positions and velocities of motions of one lane, shape (rows, 4n)."""
        position, velocity = (self._coordinates[index].absolute(half) for half in np.split(motions, 2, axis=1))
        return self._units[index].state(position, velocity)
