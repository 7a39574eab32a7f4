"""Lanes as the worlds of one model, whatever their formulation, in copies of MuJoCo that advance all at once."""

from collections.abc import Callable, Sequence
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from engines.interface.presets import Formulation, Preset
from engines.mujoco.contact import contact_model
from engines.mujoco.joint import joint_model
from engines.mujoco.pressed_contact import light_units, normal_share, pressed_harder
from engines.shared.units import Units
from engines.shared.worlds import Worlds
from engines.shared.worlds_simulation import WorldsSimulation
from reference_lcp.chain.simulation import Lane, common_cells
from reference_lcp.validation import FloatArray


class ModelsSimulation(WorldsSimulation):
    """Lanes as the worlds of one model, each with its own numbers, time step and units.

    Parameters
    ----------
    lanes
        The lanes.
    pressed
        The lanes as the models have them: some press contacts harder, with a smaller coefficient of friction.
    units
        The units of each lane's model.
    models
        A compiled `mujoco.MjModel` a lane, all of one structure: in each cell, the joints of the outer mass and of
        the inner one relative to it come first. Where contacts have sensors, these give the contact force, its normal
        part first.
    new_worlds
        Makes the worlds of models, told whether bounds of friction change from step to step.
    """

    def __init__(
        self,
        lanes: Sequence[Lane],
        pressed: Sequence[Lane],
        units: Sequence[Units],
        models: Sequence[Any],
        new_worlds: Callable[[Sequence[Any], bool], Worlds],
    ):
        worlds = new_worlds(models, any(lane.preload is not None for lane in lanes))
        super().__init__(lanes, units, models[0].nq // common_cells(lanes), worlds)
        self._pressed, self._models = tuple(pressed), tuple(models)
        self._new_worlds = new_worlds

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> Self:
        """Give the lanes of these indices; they share the models."""
        return type(self)(
            [self.lanes[lane] for lane in lanes],
            [self._pressed[lane] for lane in lanes],
            [self._units[lane] for lane in lanes],
            [self._models[lane] for lane in lanes],
            self._new_worlds,
        )

    def _friction(self, index: int, rows: FloatArray) -> FloatArray:
        """λ_T on the inner masses; where a cell has none, Newton leaves round-off of its neighbours."""
        rubs = self.lanes[index].chain.friction_bound > 0
        return np.where(rubs, rows[:, 1 :: self._joints] * self._units[index].force, 0.0)

    def _normal_force(self, index: int, rows: FloatArray, given: FloatArray) -> FloatArray:
        """λ_N as the sensors of the contacts measured it; cells without friction have no contact."""
        lane, pressed = self.lanes[index], self._pressed[index]
        if rows.shape[-1] == 0:
            return given
        measured = rows[:, ::3] * self._units[index].force * normal_share(lane, pressed)
        return np.where(lane.chain.friction_bound > 0, measured, given)


def worlds_simulation(
    lanes: tuple[Lane, ...],
    formulation: Formulation,
    preset: Preset,
    new_worlds: Callable[[Sequence[Any], bool], Worlds],
) -> ModelsSimulation:
    """Compile MuJoCo's models of the lanes, and make worlds of them."""
    if formulation is Formulation.JOINT:
        pressed, compiled = lanes, joint_model
        units = [Units.named(preset["units"], lane) for lane in lanes]
    else:
        pressed, compiled = tuple(pressed_harder(lane, preset) for lane in lanes), contact_model
        units = [light_units(lane, preset) for lane in pressed]
    models = [compiled(lane, unit, preset) for lane, unit in zip(pressed, units, strict=True)]
    return ModelsSimulation(lanes, pressed, units, models, new_worlds)
