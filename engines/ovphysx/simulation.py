"""Lanes of ovphysx as the articulations of one scene."""

from collections.abc import Iterator, Sequence
from typing import Self

import numpy as np
from numpy.typing import NDArray

from engines.interface.presets import Preset
from engines.ovphysx.scene import Scene, stage_text
from engines.shared.coordinates import CarriedCoordinates, friction_of_joints
from engines.shared.force_loop import LARGEST_MOTION
from engines.shared.units import Units
from engines.shared.worlds_simulation import LanesInUnits
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.validation import FloatArray, checked_count


class OvphysxSimulation(LanesInUnits):
    """Lanes as articulations of one scene, each in its own units, of which its time step is one."""

    def __init__(self, lanes: Sequence[Lane], preset: Preset):
        """Make the scene."""
        super().__init__(lanes, [Units.in_steps(preset["units"], lane) for lane in lanes])
        self._preset = preset
        self._time_step = lanes[0].time_step / self._units[0].time
        self._coordinates = [CarriedCoordinates.of_chain(lane.chain) for lane in lanes]
        self._chains = [units.scaled(lane.chain) for units, lane in zip(self._units, lanes, strict=True)]
        both = list(zip(self._coordinates, self._chains, strict=True))
        self._forces = np.stack([coordinates.force_matrix(chain) for coordinates, chain in both])
        self._loaded = np.zeros((len(lanes), 2 * self._chains[0].cells))
        for row, coordinates in zip(self._loaded, self._coordinates, strict=True):
            row[coordinates.loaded] = 1.0
        masses = [
            np.split(coordinates.exchanged(np.concatenate([chain.outer_mass, chain.inner_mass])), 2)
            for coordinates, chain in both
        ]
        text = stage_text([(carriers, carried) for carriers, carried in masses], preset)
        self._scene = Scene(text, preset["NUM_THREADS"])
        self._modulated = any(lane.preload is not None for lane in lanes)

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane; see `Simulation.run`.

        The last row of a lane that diverges is repeated.
        """
        shape = steps, *self._loaded.shape
        motions, along, applied = np.empty((*shape[:-1], 2 * shape[-1])), np.empty(shape), np.empty(shape)
        for row, (motion, force) in enumerate(self._steps(state, start, steps)):
            motions[row], applied[row], along[row] = motion, force, self._scene.read_joint_force()
        return [
            Trajectory(
                lane.times(start, steps),
                *self._absolute(index, motions[:, index]),
                self._friction(index, along[:, index], applied[:, index], start),
                lane.preloads(start, steps),
            )
            for index, lane in enumerate(self.lanes)
        ]

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance every lane, keep the final state; see `Simulation.advance`."""
        for motion, _ in self._steps(state, start, steps):
            last = motion
        ends = [self._absolute(index, row) for index, row in enumerate(last)]
        positions, velocities = zip(*ends, strict=True)
        return State(np.stack(positions), np.stack(velocities))

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> Self:
        """Give the lanes of these indices, in a scene of their own."""
        return type(self)([self.lanes[lane] for lane in lanes], self._preset)

    def native_steps(self, steps: int) -> None:
        """Take steps of PhysX alone, with friction; see `NativeStepping`."""
        self._scene.set(np.zeros(self._loaded.shape), np.zeros(self._loaded.shape))
        self._scene.set_friction(self._bounds(0, 1)[0])
        self._scene.step(self._loaded.astype(np.float32), self._time_step)
        self._scene.native_steps(steps - 1, self._time_step)

    def close(self) -> None:
        """Free the scene."""
        self._scene.close()

    def _steps(self, state: State, start: int, steps: int) -> Iterator[tuple[FloatArray, NDArray[np.float32]]]:
        """Take steps; gives the motion after each, shape (lanes, 4n), and the forces in it, shape (lanes, 2n)."""
        scene, moving = self._scene, np.ones((len(self.lanes), 1), dtype=bool)
        motion, force = self._begin(state, steps), np.empty(self._loaded.shape, np.float32)
        loads, bounds = self._loads(start, steps), self._bounds(start, steps if self._modulated else 1)
        scene.set_friction(bounds[0])
        for step, load in enumerate(loads):
            if self._modulated:
                scene.set_friction(bounds[step])
            given = np.matmul(self._forces, motion[..., None])[..., 0] + load[:, None] * self._loaded
            np.copyto(force, given, where=moving, casting="same_kind")
            scene.step(force, self._time_step)
            np.copyto(motion, np.hstack([scene.position, scene.velocity]), where=moving)
            yield motion, force
            if not np.max(np.abs(motion[moving[:, 0]]), initial=0.0) < LARGEST_MOTION:
                self._stop_diverged(motion, force, moving)

    def _begin(self, state: State, steps: int) -> FloatArray:
        """Give every lane its motion, and return it, shape (lanes, 4n)."""
        checked_count("steps", steps)
        state.check_fits(len(self.lanes), self.lanes[0].chain.cells)
        pairs = list(zip(self._coordinates, self._units, strict=True))
        position = np.stack([c.of(row / u.length) for (c, u), row in zip(pairs, state.positions, strict=True)])
        velocity = np.stack([c.of(row / u.velocity) for (c, u), row in zip(pairs, state.velocities, strict=True)])
        self._scene.set(position, velocity)
        return np.hstack([position, velocity])

    def _stop_diverged(self, motion: FloatArray, force: NDArray[np.float32], moving: NDArray[np.bool_]) -> None:
        """Hold lanes that have diverged, and let them rest in the scene."""
        moving &= np.max(np.abs(motion), axis=1, keepdims=True) < LARGEST_MOTION
        force[~moving[:, 0]] = 0.0
        position, velocity = np.split(np.where(moving, motion, 0.0), 2, axis=1)
        self._scene.set(position, velocity)

    def _absolute(self, index: int, motions: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Give positions [m] and velocities [m/s] of a lane, shape (..., 2n), of its motions, shape (..., 4n)."""
        position, velocity = np.split(motions, 2, axis=-1)
        coordinates, units = self._coordinates[index], self._units[index]
        return coordinates.absolute(position) * units.length, coordinates.absolute(velocity) * units.velocity

    def _friction(self, index: int, along: FloatArray, applied: FloatArray, start: int) -> FloatArray:
        """Give friction on the inner masses [N], shape (steps, n), of what acted along joints and what was applied."""
        lane, units, cells = self.lanes[index], self._units[index], self.lanes[index].chain.cells
        bound = lane.chain.friction_coefficient * lane.preloads(start, len(along)) / units.force
        friction = friction_of_joints(along[:, cells:], applied, bound, self._chains[index])
        return self._coordinates[index].sign * friction * units.force
