"""Lanes as the worlds of one model, whatever their formulation, in copies of MuJoCo that advance all at once."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from multibody_xval.engines.interface.presets import Formulation, Preset
from multibody_xval.engines.mujoco.contact import TOUCH_IN_SINGLE, compiled_contacts, light_units
from multibody_xval.engines.mujoco.joint import CompiledLane, compiled_joints
from multibody_xval.engines.shared.worlds import Worlds
from multibody_xval.engines.shared.worlds_simulation import WorldsSimulation
from reference_lcp.chain.simulation import Lane, common_cells
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.validation import FloatArray


class ModelsSimulation(WorldsSimulation):
    """Lanes as the worlds of one model, each with its own numbers, time step and units.

    `new_worlds` makes the worlds of models of one structure, told whether bounds of friction change from step to step.
    """

    def __init__(self, compiled: Sequence[CompiledLane], new_worlds: Callable[[Sequence[Any], bool], Worlds]):
        self._compiled, self._new_worlds = tuple(compiled), new_worlds
        self._models = tuple(each.model for each in compiled)
        lanes = [each.lane for each in compiled]
        worlds = new_worlds(self._models, any(lane.preload is not None for lane in lanes))
        joints = self._models[0].nq // common_cells(lanes)
        self._opens = self._models[0].nu > 1
        super().__init__(lanes, [each.units for each in compiled], joints, worlds)

    @classmethod
    def of(
        cls,
        lanes: Sequence[Lane],
        formulation: Formulation,
        preset: Preset,
        new_worlds: Callable[[Sequence[Any], bool], Worlds],
    ) -> Self:
        """Compile MuJoCo's models of the lanes, of one that is there several times once, and make worlds of them."""
        compiled: Callable[[Lane, Preset], CompiledLane] = compiled_joints
        if formulation is Formulation.CONTACT:
            lifting = any(lane.preload is not None for lane in lanes)
            preset = preset.modulated() if lifting else preset
            compiled = partial(compiled_contacts, lifting=lifting, units_of=light_units, touch=TOUCH_IN_SINGLE)
        once = {key: compiled(lane, preset) for key, lane in {id(lane): lane for lane in lanes}.items()}
        return cls([once[id(lane)] for lane in lanes], new_worlds)

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> Self:
        """Give the lanes of these indices; they share the models."""
        return type(self)([self._compiled[lane] for lane in lanes], self._new_worlds)

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane; see `Simulation.run`. An open contact has no friction, but its neighbours' round-off."""
        motions = super().run(state, start, steps)
        return [replace(each, friction=np.where(each.normal_force > 0, each.friction, 0.0)) for each in motions]

    def _pressing(self, start: int, steps: int) -> FloatArray:
        """Give what presses spheres that may leave their plates, and what bounds friction elsewhere."""
        return self._preloads(start, steps) if self._opens else super()._pressing(start, steps)

    def _friction(self, index: int, rows: FloatArray) -> FloatArray:
        """λ_T on the inner masses; where a cell has none, Newton leaves round-off of its neighbours."""
        rubs = self.lanes[index].chain.friction_bound > 0
        return np.where(rubs, rows[:, 1 :: self._joints] * self._units[index].force, 0.0)

    def _normal_force(self, index: int, rows: FloatArray, given: FloatArray) -> FloatArray:
        """λ_N as the sensors of the contacts measured it, if there are any."""
        return self._compiled[index].measured(rows, given) if rows.size else given
