"""Lanes of Genesis, whatever their formulation, as the environments of one scene."""

import weakref
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from typing import Self

import numpy as np
from numpy.typing import NDArray

from engines.genesis.scene import Scene
from engines.interface.presets import Preset
from engines.shared.coordinates import ChainCoordinates
from engines.shared.units import Units
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.stepping.sequential import LaneModel
from reference_lcp.validation import FloatArray, checked_count

LARGEST_MOTION = 1e15
"""Coordinates and velocities, in a lane's units, beyond which it has diverged: at numbers that are not finite, Genesis
would end the steps of all lanes."""

COORDINATES = ChainCoordinates.PAIRS


class GenesisSimulation(ABC):
    """Lanes as the environments of one scene, under springs, dashpots and drives as forces at the start of each step.

    Parameters
    ----------
    lanes
        At least one.
    preset
        The options.
    """

    def __init__(self, lanes: Sequence[Lane], preset: Preset):
        self.lanes, self._preset = tuple(lanes), preset
        self._units = [self._units_of(lane) for lane in lanes]
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

    def _loads(self, start: int, steps: int) -> FloatArray:
        """Give the force on cell 1 in every step, shape (steps, lanes)."""
        loads = [lane.loads(start, steps) / units.force for lane, units in zip(self.lanes, self._units, strict=True)]
        return np.stack(loads, axis=1)

    def _motion(self, state: State) -> FloatArray:
        """Give the motions of a state, each in the units of its lane, shape (lanes, 4n)."""
        length, velocity = (
            np.array([[getattr(units, name)] for units in self._units]) for name in ("length", "velocity")
        )
        return np.hstack([COORDINATES.of(state.positions / length), COORDINATES.of(state.velocities / velocity)])

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


class GenesisLane(LaneModel):
    """A lane in a scene of its own."""

    def __init__(self, simulation: GenesisSimulation):
        self.lane, self._simulation = simulation.lanes[0], simulation
        self.advance, self.close = simulation.advance, simulation.close  # type: ignore[method-assign]
        self.native_steps = simulation.native_steps

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state`; see `LaneModel.run`."""
        return self._simulation.run(state, start, steps)[0]
