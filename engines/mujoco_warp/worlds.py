"""The worlds of one batch in MuJoCo Warp's memory."""

import dataclasses
import importlib
from collections.abc import Sequence
from typing import Any

import numpy as np

from multibody_xval.engines.shared.warp_worlds import WarpWorlds, import_warp
from multibody_xval.engines.shared.worlds import Rows
from reference_lcp.validation import FloatArray

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
