"""MuJoCo's own steps, taken one by one: what `mujoco.batch.Batch` does, for versions before 3.17, which have none."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from reference_lcp.validation import FloatArray


class SteppedModels:
    """Simulations of several models, one after the other, behind the calls of a batch that the suite makes.

    Parameters
    ----------
    models
        A compiled `mujoco.MjModel` a simulation, all of the same sizes.
    """

    def __init__(self, models: Sequence[Any]):
        import mujoco

        self._models = models
        self._data = [mujoco.MjData(model) for model in models]
        self._bound: dict[str, FloatArray] = {}

    def bind(self, name: str) -> FloatArray:
        """Give a part of the state, shape (simulations, size): what is written into it is where steps begin."""
        if name not in self._bound:
            self._bound[name] = np.stack([getattr(data, name) for data in self._data])
        return self._bound[name]

    def rollout(self, control: FloatArray, record: Sequence[str]) -> dict[str, FloatArray]:
        """Take a step for each control, shape (lanes, steps, controls); gives records, shape (lanes, steps, size).

        A simulation that diverges stops, and its last row is repeated.
        """
        rows = {
            name: np.stack([np.tile(getattr(data, name), (control.shape[1], 1)) for data in self._data])
            for name in record
        }
        for index, data in enumerate(self._data):
            for name, bound in self._bound.items():
                getattr(data, name)[:] = bound[index]
            self._step(index, control[index], {name: row[index] for name, row in rows.items()})
            for name, bound in self._bound.items():
                bound[index] = getattr(data, name)
        return rows

    def _step(self, index: int, control: FloatArray, rows: dict[str, FloatArray]) -> None:
        """Take the steps of one simulation; a warning, such as of a coordinate that is too large, is its end."""
        import mujoco

        model, data = self._models[index], self._data[index]
        before = data.warning.number.tobytes()
        for step, force in enumerate(control):
            if data.warning.number.tobytes() != before:
                for row in rows.values():
                    row[step:] = row[step - 1]
                return
            data.ctrl[:] = force
            mujoco.mj_step(model, data)
            for name, row in rows.items():
                row[step] = getattr(data, name)
