"""Lanes of Genesis as the environments of one scene, and its joint formulation: the dry friction of slide joints."""

import weakref
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from typing import Self

import numpy as np
from numpy.typing import NDArray

from engines.genesis.scene import Scene, chain_model, constraint_parameters
from engines.interface.presets import Preset
from engines.mujoco.presets import SOLIMP
from engines.shared.coordinates import ChainCoordinates
from engines.shared.force_loop import LARGEST_MOTION
from engines.shared.units import Units
from engines.shared.worlds_simulation import LanesInUnits
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.validation import FloatArray, checked_count

COORDINATES = ChainCoordinates.PAIRS


class GenesisSimulation(LanesInUnits, ABC):
    """Lanes as environments of one scene, under springs, dashpots and drives as forces at the start of each step."""

    def __init__(self, lanes: Sequence[Lane], preset: Preset):
        self._preset = preset
        super().__init__(lanes, [self._units_of(lane) for lane in lanes])
        self._chains = [units.scaled(lane.chain) for lane, units in zip(lanes, self._units, strict=True)]
        self._forces = np.stack([COORDINATES.force_matrix(chain) for chain in self._chains])
        masses = [np.column_stack([chain.outer_mass, chain.inner_mass]).ravel() for chain in self._chains]
        self._scene = self._new_scene(np.stack(masses))
        # Scenes refer to themselves, and would wait for the collector of cycles.
        self._end = weakref.finalize(self, self._scene.close)

    @abstractmethod
    def _units_of(self, lane: Lane) -> Units:
        """Choose units of a lane; in those of all lanes of a scene, the time step is the same."""

    @abstractmethod
    def _new_scene(self, masses: FloatArray) -> Scene:
        """Make the scene, of masses in the units of each lane, shape (lanes, 2n)."""

    def _measured_normal_force(self, given: FloatArray) -> FloatArray:
        """Give the normal force in the last step [N], shape (lanes, n); that which is given where none is measured."""
        return given

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane; see `Simulation.run`.

        The last row of a lane that diverges is repeated.
        """
        lanes, cells = len(self.lanes), self.lanes[0].chain.cells
        motions, contacts = np.empty((steps, lanes, 4 * cells)), np.empty((steps, 2, lanes, cells))
        given = np.stack([lane.preloads(start, steps) for lane in self.lanes], axis=1)
        force_unit = np.array([[units.force] for units in self._units])
        for step, (motion, forces, live) in enumerate(self._steps(state, start, steps)):
            contacts[step] = self._scene.friction(forces) * force_unit, self._measured_normal_force(given[step])
            motions[step] = motion
            if not live.all():
                contacts[step][:, ~live] = contacts[max(step - 1, 0)][:, ~live]
        return [self._trajectory(index, start, motions[:, index], contacts[:, :, index]) for index in range(lanes)]

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance every lane, keep the final state; see `Simulation.advance`."""
        for motion, _, _ in self._steps(state, start, steps):
            end = motion
        return State.stack([self._state(index, end[index : index + 1]) for index in range(len(self.lanes))])

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> Self:
        """Give the lanes of these indices, in a scene of their own."""
        return type(self)([self.lanes[lane] for lane in lanes], self._preset)

    def native_steps(self, steps: int) -> None:
        """Take steps of Genesis alone, from where the lanes are; see `NativeStepping`."""
        self._scene.native_steps(steps)

    def close(self) -> None:
        """Free the scene."""
        self._end()

    def _steps(
        self, state: State, start: int, steps: int
    ) -> Iterator[tuple[FloatArray, FloatArray, NDArray[np.bool_]]]:
        """Set the state, and take steps; gives the motions after each, the forces in it, and which lanes moved.

        A motion is in the units of its lane, shape (lanes, 4n).
        """
        checked_count("steps", steps)
        state.check_fits(len(self.lanes), self.lanes[0].chain.cells)
        motion, live = self._motion(state), np.ones(len(self.lanes), dtype=np.bool_)
        self._scene.set_motion(*np.split(motion, 2, axis=1))
        loads = self._loads(start, steps)
        for step in range(steps):
            self._before_step(start + step)
            forces = np.matmul(self._forces, motion[:, :, None])[:, :, 0]
            forces[:, 0] += loads[step]
            if not live.all():
                forces[~live] = 0.0
            moved = self._scene.step(forces)
            # At numbers that are not finite, Genesis would end the steps of all lanes.
            diverged = ~(np.max(np.abs(moved), axis=1) < LARGEST_MOTION)
            if diverged.any():
                live &= ~diverged
                resting = np.where(live[:, None], moved, 0.0)
                self._scene.set_motion(*np.split(resting, 2, axis=1))
            motion = np.where(live[:, None], moved, motion)
            yield motion, forces, live

    def _before_step(self, step: int) -> None:
        """Set what changes from step to step."""
        return

    def _motion(self, state: State) -> FloatArray:
        """Give the motions of a state, each in the units of its lane, shape (lanes, 4n)."""
        return np.hstack(
            [COORDINATES.of(state.positions / self._length), COORDINATES.of(state.velocities / self._velocity)]
        )

    def _state(self, lane: int, motions: FloatArray) -> State:
        """Give positions and velocities of motions of one lane, shape (rows, 4n)."""
        position, velocity = np.split(motions, 2, axis=1)
        return self._units[lane].state(COORDINATES.absolute(position), COORDINATES.absolute(velocity))

    def _trajectory(self, index: int, start: int, motions: FloatArray, contacts: FloatArray) -> Trajectory:
        """Give the trajectory of one lane; where a cell has no friction, Genesis leaves the round-off of forces."""
        lane, state = self.lanes[index], self._state(index, motions)
        friction = np.where(lane.chain.friction_bound > 0, contacts[:, 0], 0.0)
        times = lane.times(start, len(motions))
        return Trajectory(times, state.positions, state.velocities, friction, contacts[:, 1])


class JointSimulation(GenesisSimulation):
    """Lanes with a dry friction in every joint of an inner mass."""

    def _units_of(self, lane: Lane) -> Units:
        if self._preset["units"] == "steps":
            return Units(length=lane.time_step**2, mass=1.0, time=lane.time_step)
        return Units.in_steps(self._preset["units"], lane)

    def _new_scene(self, masses: FloatArray) -> Scene:
        cells = self.lanes[0].chain.cells
        scene = Scene(chain_model(cells)[0], masses, 1.0, self._preset)
        scene.set_joint_constraints(
            np.stack([constraint_parameters(self._time_constant(lane), 1.0, SOLIMP) for lane in self.lanes])
        )
        scene.set_bounds(np.stack([chain.friction_bound for chain in self._chains]))
        return scene

    def _time_constant(self, lane: Lane) -> float:
        """Give the time constant of friction in time steps; Genesis takes at least two."""
        if "time constant" not in self._preset.options:
            steps: float = self._preset["time constant in steps"]
            return steps
        return max(2.0, self._preset["time constant"] / lane.time_step)

    def _before_step(self, step: int) -> None:
        if any(lane.preload is not None for lane in self.lanes):
            self._scene.set_bounds(self._bounds(step, 1)[0])
