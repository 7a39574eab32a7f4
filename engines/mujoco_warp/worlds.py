"""Lanes of MuJoCo Warp as the worlds of one model: MuJoCo's, compiled by its adapter, in units for single precision."""

import dataclasses
import importlib
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from multibody_xval.engines.interface.presets import Formulation, Preset
from multibody_xval.engines.mujoco.contact import compiled_contacts, contact_units
from multibody_xval.engines.mujoco.joint import CompiledLane, compiled_joints
from multibody_xval.engines.shared.units import Units, power_of_two
from multibody_xval.engines.shared.warp_worlds import Rows, WarpWorlds, import_warp
from multibody_xval.engines.shared.worlds_simulation import WorldsSimulation
from reference_lcp.chain.simulation import Lane, common_cells
from reference_lcp.validation import FloatArray

TOUCH_IN_SINGLE = 2.0**-18
"""Depth of a sphere that may leave its plate, over the displacement scale: four roundings of where a sphere is."""

ROWS_OF_A_CONTACT = 4
"""Most constraints that a contact makes: the edges of its pyramid."""


class MuJoCoWarpWorlds(WarpWorlds):
    """Models of MuJoCo as worlds; in `modulated` ones the bounds of joints, or what presses, change in every step.

    A control loads cell 1; where spheres may leave their plates, others lift them.
    """

    def __init__(self, models: Sequence[Any], modulated: bool):
        self._models, self._modulated = models, modulated
        super().__init__(len(models), models[0].nbody // 2)

    def _allocate(self) -> Rows:
        model, engine = self._models[0], import_mujoco_warp()
        rows = model.nv + ROWS_OF_A_CONTACT * model.npair
        self._model = _batched_model(self._models)
        self._data = engine.make_data(model, nworld=len(self._models), nconmax=model.npair, njmax=rows)
        return Rows(self._data.qpos, self._data.qvel, self._data.qfrc_constraint, self._data.sensordata)

    def _set(self, positions: FloatArray, velocities: FloatArray) -> None:
        self._data.qpos.assign(positions)
        self._data.qvel.assign(velocities)
        self._data.qacc_warmstart.zero_()

    def _set_forces(self) -> None:
        from multibody_xval.engines.shared import warp_kernels as kernels

        warp = import_warp()
        warp.launch(kernels.load, len(self._models), [self._step, self._loads, self._data.ctrl])
        if self._models[0].nu > 1:
            warp.launch(kernels.press, self._pressing.shape[1:], [self._step, self._pressing, self._data.ctrl])
        elif self._modulated:
            bounds = self._pressing
            warp.launch(kernels.bound, bounds.shape[1:], [self._step, bounds, self._model.dof_frictionloss])

    def _advance(self) -> None:
        import_mujoco_warp().step(self._model, self._data)


def _batched_model(models: Sequence[Any]) -> Any:
    """Give one model for MuJoCo Warp, with a row a world of friction bounds, and of whatever differs between models."""
    import mujoco_warp
    import warp

    distinct = {id(model): model for model in models}.values()

    def differs(name: str) -> bool:
        first = getattr(models[0], name, None)
        if not isinstance(first, np.ndarray):
            return False
        return any(not np.array_equal(first, getattr(model, name)) for model in distinct)

    differing = {field.name for field in dataclasses.fields(mujoco_warp.Model) if differs(field.name)}
    names = sorted(differing | {"dof_frictionloss"})
    batched = mujoco_warp.put_model(models[0], batch_sizes=dict.fromkeys(names, len(models)))
    for name in names:
        rows = getattr(batched, name)
        rows.assign(np.stack([getattr(model, name) for model in models]).reshape(rows.numpy().shape))
    batched.opt.timestep = warp.array([model.opt.timestep for model in models], dtype=float)
    batched.opt.warn_overflow = 0  # a solver that ends at its last iteration says so on standard output
    return batched


def import_mujoco_warp() -> Any:
    """Import MuJoCo Warp, once Warp is silent."""
    import_warp()
    return importlib.import_module("mujoco_warp")


class MuJoCoWarpSimulation(WorldsSimulation):
    """Lanes as the worlds of one model, each with its own numbers, time step and units."""

    def __init__(self, compiled: Sequence[CompiledLane]):
        self._compiled, models = tuple(compiled), [each.model for each in compiled]
        lanes = [each.lane for each in compiled]
        worlds = MuJoCoWarpWorlds(models, any(lane.preload is not None for lane in lanes))
        self._opens = models[0].nu > 1
        super().__init__(lanes, [each.units for each in compiled], models[0].nq // common_cells(lanes), worlds)

    @classmethod
    def of(cls, lanes: Sequence[Lane], formulation: Formulation, preset: Preset) -> Self:
        """Compile MuJoCo's models of the lanes, of one that is there several times once, and make worlds of them."""
        compiled: Callable[[Lane, Preset], CompiledLane] = compiled_joints
        if formulation is Formulation.CONTACT:
            lifting = any(lane.preload is not None for lane in lanes)
            preset = preset.modulated() if lifting else preset
            compiled = partial(compiled_contacts, lifting=lifting, units_of=light_units, touch=TOUCH_IN_SINGLE)
        once = {key: compiled(lane, preset) for key, lane in {id(lane): lane for lane in lanes}.items()}
        return cls([once[id(lane)] for lane in lanes])

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> Self:
        """Give the lanes of these indices; they share the models."""
        return type(self)([self._compiled[lane] for lane in lanes])

    def _pressing(self, start: int, steps: int) -> FloatArray:
        """Give what presses spheres that may leave their plates, and what bounds friction elsewhere."""
        return self._preloads(start, steps) if self._opens else super()._pressing(start, steps)

    def _contact_forces(
        self, index: int, friction: FloatArray, normal_force: FloatArray, given: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Give forces as joints and sensors have them; where nothing rubs, Newton leaves round-off of neighbours."""
        normal = self._compiled[index].measured(normal_force, given) if normal_force.size else given
        rubs = (self.lanes[index].chain.friction_bound > 0) & (normal > 0)
        return np.where(rubs, friction[:, 1 :: self._joints] * self._units[index].force, 0.0), normal


def light_units(lane: Lane, preset: Preset) -> Units:
    """Choose units in which the masses that contacts stop are near one: single precision takes small ones for none."""
    units, chain = contact_units(lane, preset), lane.chain
    if preset["units"] == "SI":
        return units
    stopped = 1 / (1 / chain.outer_mass + 1 / chain.inner_mass)
    return replace(units, mass=power_of_two(float(np.exp(np.mean(np.log(stopped))))))
