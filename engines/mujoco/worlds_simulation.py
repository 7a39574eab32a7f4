"""Lanes as the worlds of one model, whatever their formulation, in copies of MuJoCo that advance all at once."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from engines.interface.presets import Formulation, Preset
from engines.mujoco.contact import contact_model
from engines.mujoco.joint import joint_model
from engines.mujoco.pressed_contact import light_units, normal_share, pressed_harder
from engines.mujoco.worlds import CHUNK, Rows, Worlds
from engines.shared.cell_joints import absolute_coordinates, joint_coordinates
from engines.shared.units import Units
from reference_lcp.chain.simulation import Lane, common_cells
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.validation import FloatArray, checked_count


class WorldsSimulation:
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
        self.lanes, self._pressed = tuple(lanes), tuple(pressed)
        self._units, self._models = tuple(units), tuple(models)
        self._joints = models[0].nq // common_cells(lanes)
        self._length = np.array([[unit.length] for unit in units])
        self._velocity = np.array([[unit.velocity] for unit in units])
        self._new_worlds = new_worlds
        self._worlds = new_worlds(models, any(lane.preload is not None for lane in lanes))

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane; see `Simulation.run`.

        The last finite row of a lane that diverges is repeated.
        """
        chunks = list(self._chunks(state, start, steps))
        rows = Rows(*(np.concatenate(parts) for parts in zip(*chunks, strict=True)))
        return [
            Trajectory(
                lane.times(start, steps),
                absolute_coordinates(rows.qpos[:, index], self._joints) * units.length,
                absolute_coordinates(rows.qvel[:, index], self._joints) * units.velocity,
                self._friction(index, rows),
                self._normal_force(index, rows, start, steps),
            )
            for index, (lane, units) in enumerate(zip(self.lanes, self._units, strict=True))
        ]

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance every lane, keep the final state; see `Simulation.advance`."""
        for chunk in self._chunks(state, start, steps):
            last = chunk
        position, velocity = (absolute_coordinates(rows[-1], self._joints) for rows in (last.qpos, last.qvel))
        return State(position * self._length, velocity * self._velocity)

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> Self:
        """Give the lanes of these indices; they share the models."""
        return type(self)(
            [self.lanes[lane] for lane in lanes],
            [self._pressed[lane] for lane in lanes],
            [self._units[lane] for lane in lanes],
            [self._models[lane] for lane in lanes],
            self._new_worlds,
        )

    def native_steps(self, steps: int) -> None:
        """Take steps of the engine alone; see `NativeStepping`."""
        self._worlds.native_steps(steps)

    def close(self) -> None:
        """Nothing to do: memory is all that it holds, and it goes with the last reference."""
        return

    def _chunks(self, state: State, start: int, steps: int) -> Iterator[Rows]:
        """Set the state, and give the rows of `steps` steps, some at a time."""
        checked_count("steps", steps)
        state.check_fits(len(self.lanes), self.lanes[0].chain.cells)
        self._worlds.set(
            joint_coordinates(state.positions / self._length, self._joints),
            joint_coordinates(state.velocities / self._velocity, self._joints),
        )
        for first in range(start, start + steps, CHUNK):
            length = min(CHUNK, start + steps - first)
            yield self._worlds.steps(self._loads(first, length), self._bounds(first, length))

    def _loads(self, start: int, steps: int) -> FloatArray:
        """Give the force on cell 1 in every step, shape (steps, lanes)."""
        loads = [lane.loads(start, steps) / units.force for lane, units in zip(self.lanes, self._units, strict=True)]
        return np.stack(loads, axis=1)

    def _bounds(self, start: int, steps: int) -> FloatArray:
        """Give μ λ_N of every contact in every step, shape (steps, lanes, n)."""
        bounds = [
            lane.chain.friction_coefficient * lane.preloads(start, steps) / units.force
            for lane, units in zip(self.lanes, self._units, strict=True)
        ]
        return np.stack(bounds, axis=1)

    def _friction(self, index: int, rows: Rows) -> FloatArray:
        """λ_T on the inner masses; where a cell has none, Newton leaves round-off of its neighbours."""
        rubs = self.lanes[index].chain.friction_bound > 0
        return np.where(rubs, rows.qfrc_constraint[:, index, 1 :: self._joints] * self._units[index].force, 0.0)

    def _normal_force(self, index: int, rows: Rows, start: int, steps: int) -> FloatArray:
        """λ_N as the sensors of the contacts measured it; cells without friction have no contact."""
        lane, pressed, units = self.lanes[index], self._pressed[index], self._units[index]
        given = lane.preloads(start, steps)
        if rows.sensordata.shape[-1] == 0:
            return given
        rubs = lane.chain.friction_bound > 0
        return np.where(rubs, rows.sensordata[:, index, ::3] * units.force * normal_share(lane, pressed), given)


def worlds_simulation(
    lanes: tuple[Lane, ...],
    formulation: Formulation,
    preset: Preset,
    new_worlds: Callable[[Sequence[Any], bool], Worlds],
) -> WorldsSimulation:
    """Compile MuJoCo's models of the lanes, and make worlds of them."""
    if formulation is Formulation.JOINT:
        pressed, compiled = lanes, joint_model
        units = [Units.named(preset["units"], lane) for lane in lanes]
    else:
        pressed, compiled = tuple(pressed_harder(lane, preset) for lane in lanes), contact_model
        units = [light_units(lane, preset) for lane in pressed]
    models = [compiled(lane, unit, preset) for lane, unit in zip(pressed, units, strict=True)]
    return WorldsSimulation(lanes, pressed, units, models, new_worlds)
