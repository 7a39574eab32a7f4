"""Lanes of Genesis as the environments of one scene, and its joint formulation: the dry friction of slide joints."""

from abc import abstractmethod
from collections.abc import Sequence
from typing import Self

import numpy as np
from numpy.typing import NDArray

from multibody_xval.engines.genesis.chains import Scene, chain_model, constraint_parameters
from multibody_xval.engines.interface.presets import OfStep, Preset
from multibody_xval.engines.shared.coordinates import JointCoordinates
from multibody_xval.engines.shared.forced_lanes import ForcedLanes
from multibody_xval.engines.shared.units import Units
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray


class GenesisSimulation(ForcedLanes):
    """Lanes as environments of one scene."""

    _joints: int = 2
    """Of a cell."""

    def __init__(self, lanes: Sequence[Lane], preset: Preset):
        self._preset = preset
        own = JointCoordinates(self._joints)
        super().__init__(lanes, [self._units_of(lane) for lane in lanes], [own] * len(lanes))

    @abstractmethod
    def _units_of(self, lane: Lane) -> Units:
        """Choose units of a lane; in those of all lanes of a scene, the time step is the same."""

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> Self:
        """Give the lanes of these indices, in a scene of their own."""
        return type(self)([self.lanes[lane] for lane in lanes], self._preset)

    def _of_chains(self, name: str) -> FloatArray:
        """Give a number of every cell of every lane, in the units of the lane, shape (lanes, n)."""
        return np.stack([getattr(chain, name) for chain in self._chains])

    def _masses(self) -> FloatArray:
        """Give the masses of all bodies, shape (lanes, 2n)."""
        outer, inner = self._of_chains("outer_mass"), self._of_chains("inner_mass")
        return np.stack([outer, inner], axis=-1).reshape(len(self.lanes), -1)

    def _contacts(self, forces: FloatArray) -> FloatArray:
        return self._scene.friction(forces)

    def _contact_forces(self, index: int, read: FloatArray, given: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Where a cell has no friction, Genesis leaves the round-off of forces."""
        rubs = self.lanes[index].chain.friction_bound > 0
        return np.where(rubs, read[:, : rubs.size] * self._units[index].force, 0.0), given


class JointSimulation(GenesisSimulation):
    """Lanes with a dry friction in every joint of an inner mass."""

    def _units_of(self, lane: Lane) -> Units:
        if self._preset["units"] == "steps":
            return Units(length=lane.time_step**2, mass=1.0, time=lane.time_step)
        return Units.in_steps(self._preset["units"], lane)

    def _new_scene(self) -> Scene:
        scene = Scene(chain_model(self.lanes[0].chain.cells)[0], self._masses(), 1.0, self._preset)
        scene.set_joint_constraints(
            np.stack(
                [
                    constraint_parameters(self._time_constant(lane), 1.0, self._preset["solimplimit"])
                    for lane in self.lanes
                ]
            )
        )
        scene.set_bounds(self._of_chains("friction_bound"))
        return scene

    def _set_bounds(self, bounds: FloatArray) -> None:
        self._scene.set_bounds(bounds)

    def _time_constant(self, lane: Lane) -> float:
        """Give the time constant of friction in time steps; Genesis takes at least two."""
        own = self._preset["constraint_timeconst"]
        return max(2.0, own.at(1.0) if isinstance(own, OfStep) else own / lane.time_step)
