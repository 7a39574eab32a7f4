"""Lanes of MuJoCo whose springs yield, and remember it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from engines.interface.presets import Preset
from engines.mujoco.simulation import MuJoCoSimulation
from engines.mujoco.yielding_spring import yielding_model
from engines.mujoco.yielding_state import deflections_at
from engines.shared.units import Units
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.validation import FloatArray


class YieldingSimulation(MuJoCoSimulation):
    """Lanes whose internal state is the deflection of every spring [m], shape (lanes, n).

    Deflections, unlike the lengths at which the springs are slack, stay valid when a search of periodic orbits moves
    all masses. Friction is that of the springs at the end of each step.
    """

    def __init__(self, lanes: Sequence[Lane], pressed: Sequence[Lane], units: Sequence[Units], models: Sequence[Any]):
        super().__init__(lanes, pressed, units, models)
        self._recorded = ("qpos", "qvel", "plastic")
        cells = lanes[0].chain.cells
        own = np.stack([model.tendon_stiffness[:cells] for model in models])
        self._stiffness = own * np.array([[unit.force / unit.length] for unit in units])

    def _set_internal_state(self, state: State, start: int) -> None:
        """Set where the springs are slack: MuJoCo keeps two ends a tendon, which are one here."""
        deflection = np.stack(
            [
                deflections_at(state.subset([index]), lane, start, self._stiffness[index])
                for index, lane in enumerate(self.lanes)
            ]
        )
        slack = self._batch.bind("qpos")[:, 1 :: self._joints] - deflection / self._length
        self._batch.bind("plastic")[:] = np.repeat(slack, 2, axis=1)

    def _state(self, part: Callable[[str], FloatArray]) -> State:
        deflection = self._deflection(part("qpos"), part("plastic")) * self._length
        return replace(super()._state(part), internal_state=deflection)

    def _friction(self, index: int, record: Mapping[str, FloatArray]) -> FloatArray:
        deflection = self._deflection(record["qpos"][index], record["plastic"][index]) * self._units[index].length
        friction: FloatArray = -self._stiffness[index] * deflection
        return friction

    def _deflection(self, qpos: FloatArray, plastic: FloatArray) -> FloatArray:
        return qpos[..., 1 :: self._joints] - plastic[..., ::2]


def yielding_simulation(lanes: tuple[Lane, ...], preset: Preset) -> YieldingSimulation:
    """Compile the lanes, and make a simulation of them."""
    units = [Units.named(preset["units"], lane) for lane in lanes]
    models = [yielding_model(lane, unit, preset) for lane, unit in zip(lanes, units, strict=True)]
    return YieldingSimulation(lanes, lanes, units, models)
