"""The worlds of one batch in MuJoCo Warp's memory, and the graph of their step."""

import functools
import importlib
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from engines.mujoco.worlds import CHUNK, Rows, Worlds
from engines.mujoco_warp.model import batched_model
from engines.shared.silence import silent_standard_error
from reference_lcp.validation import FloatArray

DEVICE = "cpu"
"""The processor: a graphics card may be there, and is not needed."""

ROWS_OF_A_CONTACT = 4
"""Most constraints that a contact makes: the edges of its pyramid."""


class WarpWorlds(Worlds):
    """Worlds of one structure that take their steps together.

    A step is recorded once as a graph: launched kernel by kernel from Python it takes a hundred times as long. The
    graph holds no numbers of its own: it finds its loads, and where its record goes, by a counter of steps.

    Parameters
    ----------
    models
        A compiled `mujoco.MjModel` a world, with one control.
    modulated
        The bounds of friction in joints change from step to step.
    """

    def __init__(self, models: Sequence[Any], modulated: bool):
        self._models, self._modulated = models, modulated
        with import_warp()[0].ScopedDevice(DEVICE):
            self._allocate()
        self.eager_step()  # compiles what this machine has not kept
        self.launch = self._captured(self.eager_step)

    def eager_step(self) -> None:
        """Load, take and record a step, kernel by kernel."""
        from engines.mujoco_warp import kernels

        warp, mujoco_warp = import_warp()
        with warp.ScopedDevice(DEVICE):
            warp.launch(kernels.load, self._data.ctrl.shape, [self._step, self._controls, self._data.ctrl])
            if self._modulated:
                frictionloss = self._model.dof_frictionloss
                warp.launch(kernels.bound, self._bounds.shape[1:], [self._step, self._bounds, frictionloss])
            mujoco_warp.step(self._model, self._data)
            for values, record in zip(self._values, self._record, strict=True):
                warp.launch(kernels.record, values.shape, [self._step, values, record])
            warp.launch(kernels.count, 1, [self._step])

    def native_steps(self, steps: int) -> None:
        """Take steps of MuJoCo Warp alone, as a graph, from where the worlds are."""
        _, mujoco_warp = import_warp()
        launch = self._captured(lambda: mujoco_warp.step(self._model, self._data))
        for _ in range(steps):
            launch()

    @property
    def _sensors(self) -> int:
        return int(self._models[0].nsensordata)

    def _set(self, qpos: FloatArray, qvel: FloatArray) -> None:
        self._data.qpos.assign(qpos)
        self._data.qvel.assign(qvel)
        self._data.qacc_warmstart.zero_()

    def _steps(self, loads: FloatArray, bounds: FloatArray) -> Rows:
        self._controls.numpy()[: len(loads), :, 0] = loads
        self._bounds.numpy()[: len(loads)] = bounds
        self._step.zero_()
        for _ in range(len(loads)):
            self.launch()
        return Rows(*(record.numpy()[: len(loads)].astype(np.float64) for record in self._record))

    def _allocate(self) -> None:
        """Put models, states, loads and records into Warp's memory."""
        warp, mujoco_warp = import_warp()
        model, size = self._models[0], len(self._models)
        rows = model.nv + ROWS_OF_A_CONTACT * model.npair
        self._model = batched_model(self._models)
        self._data = mujoco_warp.make_data(model, nworld=size, nconmax=model.npair, njmax=rows)
        self._step = warp.zeros(1, dtype=int)
        self._controls = warp.zeros((CHUNK, size, 1), dtype=float)
        self._bounds = warp.zeros((CHUNK, size, model.nbody // 2), dtype=float)
        self._values = [getattr(self._data, name) for name in Rows._fields]
        self._record = [warp.zeros((CHUNK, *values.shape), dtype=float) for values in self._values]

    def _captured(self, steps: Callable[[], None]) -> Callable[[], None]:
        """Record what is launched as a graph; give the function that launches it again."""
        warp, _ = import_warp()
        with warp.ScopedDevice(DEVICE), warp.ScopedCapture(DEVICE) as capture:
            steps()
        return functools.partial(warp.capture_launch, capture.graph)


@functools.cache
def import_warp() -> tuple[Any, Any]:
    """Import Warp and MuJoCo Warp; Warp does not tell what it compiles, nor that there is no graphics card."""
    warp = importlib.import_module("warp")
    warp.config.log_level = warp.LOG_ERROR
    with silent_standard_error():
        warp.init()
    return warp, importlib.import_module("mujoco_warp")
