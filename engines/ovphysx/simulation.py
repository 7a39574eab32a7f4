"""Lanes of ovphysx as the articulations of one scene."""

from collections.abc import Sequence
from typing import Self

import numpy as np
from numpy.typing import NDArray

from engines.interface.presets import Preset
from engines.ovphysx.scene import Scene, stage_text
from engines.shared.coordinates import CarriedCoordinates, friction_of_joints
from engines.shared.forced_lanes import ForcedLanes
from engines.shared.units import Units
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray


class OvphysxSimulation(ForcedLanes):
    """Lanes as articulations of one scene, each in its own units, of which its time step is one."""

    def __init__(self, lanes: Sequence[Lane], preset: Preset):
        self._preset = preset
        self._carried = [CarriedCoordinates.of_chain(lane.chain) for lane in lanes]
        super().__init__(lanes, [Units.in_steps(preset["units"], lane) for lane in lanes], self._carried)

    def _new_scene(self) -> Scene:
        masses = [
            np.split(own.exchanged(np.concatenate([chain.outer_mass, chain.inner_mass])), 2)
            for own, chain in zip(self._carried, self._chains, strict=True)
        ]
        text = stage_text([(carriers, carried) for carriers, carried in masses], self._preset)
        scene = Scene(text, self._preset["NUM_THREADS"], self.lanes[0].time_step / self._units[0].time)
        scene.set_friction(self._bounds(0, 1)[0])
        return scene

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> Self:
        """Give the lanes of these indices, in a scene of their own."""
        return type(self)([self.lanes[lane] for lane in lanes], self._preset)

    def native_steps(self, steps: int) -> None:
        """Take steps of PhysX alone, with friction; see `NativeStepping`."""
        self._scene.set_motion(np.zeros(self._loaded.shape), np.zeros(self._loaded.shape))
        self._scene.set_friction(self._bounds(0, 1)[0])
        self._scene.step(self._loaded)
        self._scene.native_steps(steps - 1)

    def _set_bounds(self, bounds: FloatArray) -> None:
        self._scene.set_friction(bounds)

    def _contacts(self, forces: FloatArray) -> FloatArray:
        """Read what acts along joints, and give with it what was applied, in single precision as PhysX has it."""
        return np.hstack([self._scene.read_joint_force(), forces.astype(np.float32)]).astype(np.float64)

    def _contact_forces(self, index: int, read: FloatArray, given: FloatArray) -> tuple[FloatArray, FloatArray]:
        lane, units, cells = self.lanes[index], self._units[index], self.lanes[index].chain.cells
        bound = lane.chain.friction_coefficient * given / units.force
        along, applied = read[:, cells : 2 * cells], read[:, 2 * cells :]
        friction = friction_of_joints(along, applied, bound, self._chains[index])
        return self._carried[index].sign * friction * units.force, given
