"""The worlds of one batch in MuJoCo Warp's memory."""

import importlib
from collections.abc import Sequence
from typing import Any

from engines.mujoco_warp.model import batched_model
from engines.shared.warp_worlds import WarpWorlds, import_warp
from engines.shared.worlds import Rows
from reference_lcp.validation import FloatArray

ROWS_OF_A_CONTACT = 4
"""Most constraints that a contact makes: the edges of its pyramid."""


class MuJoCoWarpWorlds(WarpWorlds):
    """Models of MuJoCo as worlds.

    Parameters
    ----------
    models
        A compiled `mujoco.MjModel` a world, with one control.
    modulated
        The bounds of friction in joints change from step to step.
    """

    def __init__(self, models: Sequence[Any], modulated: bool):
        self._models, self._modulated = models, modulated
        super().__init__(len(models), models[0].nbody // 2)

    def _allocate(self) -> Rows:
        model, engine = self._models[0], import_mujoco_warp()
        rows = model.nv + ROWS_OF_A_CONTACT * model.npair
        self._model = batched_model(self._models)
        self._data = engine.make_data(model, nworld=len(self._models), nconmax=model.npair, njmax=rows)
        return Rows(self._data.qpos, self._data.qvel, self._data.qfrc_constraint, self._data.sensordata)

    def _set(self, positions: FloatArray, velocities: FloatArray) -> None:
        self._data.qpos.assign(positions)
        self._data.qvel.assign(velocities)
        self._data.qacc_warmstart.zero_()

    def _set_forces(self) -> None:
        from engines.mujoco_warp import kernels

        warp = import_warp()
        warp.launch(kernels.load, len(self._models), [self._step, self._loads, self._data.ctrl])
        if self._modulated:
            bounds = self._pressing
            warp.launch(kernels.bound, bounds.shape[1:], [self._step, bounds, self._model.dof_frictionloss])

    def _advance(self) -> None:
        import_mujoco_warp().step(self._model, self._data)


def import_mujoco_warp() -> Any:
    """Import MuJoCo Warp, once Warp is silent."""
    import_warp()
    return importlib.import_module("mujoco_warp")
