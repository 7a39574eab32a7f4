"""Lanes of Genesis as the environments of one scene, and its joint formulation: the dry friction of slide joints.

Springs, dashpots and drives are forces of the adapter, computed at the start of each step.
"""

import weakref
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from typing import Self

import numpy as np
from numpy.typing import NDArray

from multibody_xval.engines.genesis.chains import Chains, chain_model, constraint_parameters
from multibody_xval.engines.interface.presets import OfStep, Preset
from multibody_xval.engines.shared.coordinates import JointCoordinates
from multibody_xval.engines.shared.force_loop import LARGEST_MOTION
from multibody_xval.engines.shared.units import Units
from multibody_xval.engines.shared.worlds_simulation import LanesOfJoints
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.validation import FloatArray, checked_count


class GenesisSimulation(LanesOfJoints, ABC):
    """Lanes of one scene, each in units of its own.

    A motion of all lanes, a row each, holds joint coordinates, then their rates.
    """

    _joints = 2

    def __init__(self, lanes: Sequence[Lane], preset: Preset):
        self._preset = preset
        super().__init__(lanes, [self._units_of(lane) for lane in lanes])
        self._chains = [unit.scaled(lane.chain) for unit, lane in zip(self._units, lanes, strict=True)]
        self._forces = np.stack([JointCoordinates(self._joints).force_matrix(chain) for chain in self._chains])
        self._loaded = np.eye(1, self._forces.shape[1])
        self._modulated = any(lane.preload is not None for lane in lanes)
        self._scene = self._new_scene()
        # Scenes may refer to themselves, and would wait for the collector of cycles.
        self._end = weakref.finalize(self, self._scene.close)

    @abstractmethod
    def _units_of(self, lane: Lane) -> Units:
        """Choose units of a lane; in those of all lanes of a scene, the time step is the same."""

    @abstractmethod
    def _new_scene(self) -> Chains:
        """Make the scene of all lanes."""

    def _set_bounds(self, bounds: FloatArray) -> None:
        """Set the bounds of friction of the next step, shape (lanes, n), where they change in time."""
        raise NotImplementedError("what presses is fixed")

    def _contacts(self, forces: FloatArray) -> FloatArray:
        """Read what the scene tells of contacts after a step under these forces, a row a lane."""
        return self._scene.friction(forces)

    def _contact_forces(self, index: int, read: FloatArray, given: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Give friction and normal force [N] of a lane, of what was read, a row a step, and what presses contacts.

        Where a cell has no friction, Genesis leaves the round-off of forces.
        """
        rubs = self.lanes[index].chain.friction_bound > 0
        return np.where(rubs, read[:, : rubs.size] * self._units[index].force, 0.0), given

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane; see `Simulation.run`.

        The last row of a lane that diverges is repeated.
        """
        motions: list[FloatArray] = []
        rows: list[FloatArray] = []
        for motion, acting, live in self._steps(state, start, steps):
            contacts = self._contacts(acting)
            if rows:
                contacts[~live] = rows[-1][~live]
            motions.append(motion)
            rows.append(contacts)
        positions, velocities = np.split(np.stack(motions, axis=1), 2, axis=2)
        read = np.stack(rows, axis=1)

        def forces(index: int) -> tuple[FloatArray, FloatArray]:
            return self._contact_forces(index, read[index], self.lanes[index].preloads(start, steps))

        return self._trajectories(start, positions, velocities, forces)

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance every lane, keep the final state; see `Simulation.advance`."""
        for motion, _, _ in self._steps(state, start, steps):
            end = motion
        return self._state_at(*np.split(end, 2, axis=1))

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> Self:
        """Give the lanes of these indices, in a scene of their own."""
        return type(self)([self.lanes[lane] for lane in lanes], self._preset)

    def close(self) -> None:
        """Free the scene."""
        self._end()

    def _steps(
        self, state: State, start: int, steps: int
    ) -> Iterator[tuple[FloatArray, FloatArray, NDArray[np.bool_]]]:
        """Set the state, and take steps; gives the motions after each, the forces in it, and which lanes moved."""
        checked_count("steps", steps)
        state.check_fits(len(self.lanes), self.lanes[0].chain.freedoms)
        motion, live = np.hstack(self._coordinates(state)), np.ones(len(self.lanes), dtype=np.bool_)
        self._scene.set_motion(*np.split(motion, 2, axis=1))
        bounds = self._bounds(start, steps) if self._modulated else ()
        for step, load in enumerate(self._loads(start, steps)):
            if self._modulated:
                self._set_bounds(bounds[step])
            forces = np.matmul(self._forces, motion[:, :, None])[:, :, 0] + load[:, None] * self._loaded
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

    def _of_chains(self, name: str) -> FloatArray:
        """Give a number of every cell of every lane, in the units of the lane, shape (lanes, n)."""
        return np.stack([getattr(chain, name) for chain in self._chains])

    def _masses(self) -> FloatArray:
        """Give the masses of all bodies, shape (lanes, 2n)."""
        outer, inner = self._of_chains("outer_mass"), self._of_chains("inner_mass")
        return np.stack([outer, inner], axis=-1).reshape(len(self.lanes), -1)


class JointSimulation(GenesisSimulation):
    """Lanes with a dry friction in every joint of an inner mass."""

    def _units_of(self, lane: Lane) -> Units:
        if self._preset["units"] == "steps":
            return Units(length=lane.time_step**2, mass=1.0, time=lane.time_step)
        return Units.in_steps(self._preset["units"], lane)

    def _new_scene(self) -> Chains:
        scene = Chains(chain_model(self.lanes[0].chain.cells), self._masses(), 1.0, self._preset)
        hardness = self._preset["solimplimit"]
        constants = [constraint_parameters(self._time_constant(lane), 1.0, hardness) for lane in self.lanes]
        scene.set_joint_constraints(np.stack(constants))
        scene.set_bounds(self._of_chains("friction_bound"))
        return scene

    def _set_bounds(self, bounds: FloatArray) -> None:
        self._scene.set_bounds(bounds)

    def _time_constant(self, lane: Lane) -> float:
        """Give the time constant of friction in time steps; Genesis takes at least two."""
        own = self._preset["constraint_timeconst"]
        return max(2.0, own.at(1.0) if isinstance(own, OfStep) else own / lane.time_step)
