"""Lanes of Newton, whatever their formulation, as worlds of one model, or each as the world of its own."""

from collections.abc import Sequence
from typing import Self

import numpy as np
from numpy.typing import NDArray

from engines.interface.presets import Formulation, Preset
from engines.newton.contact import ContactWorlds
from engines.newton.joint import JointWorlds
from engines.newton.worlds import NewtonWorlds
from engines.shared.box_geometry import PressedBoxes
from engines.shared.units import Units
from engines.shared.worlds_simulation import WorldsSimulation
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.stepping.sequential import LaneModel
from reference_lcp.validation import FloatArray


class NewtonSimulation(WorldsSimulation):
    """Lanes as the worlds of one model; in their units, all have the same time step.

    Parameters
    ----------
    lanes
        The lanes.
    formulation, preset
        What they are.
    """

    def __init__(self, lanes: Sequence[Lane], formulation: Formulation, preset: Preset):
        units = [Units.in_steps(preset["units"], lane) for lane in lanes]
        self._formulation, self._preset = formulation, preset
        worlds = _worlds(lanes, units, formulation, preset)
        super().__init__(lanes, units, worlds.joints, worlds)

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> Self:
        """Give the lanes of these indices."""
        return type(self)([self.lanes[lane] for lane in lanes], self._formulation, self._preset)

    def _pressing(self, start: int, steps: int) -> FloatArray:
        """Give what bounds friction: in joints μ λ_N, in contacts λ_N itself."""
        if self._formulation is Formulation.JOINT:
            return super()._pressing(start, steps)
        forces = [lane.preloads(start, steps) / unit.force for lane, unit in zip(self.lanes, self._units, strict=True)]
        return np.stack(forces, axis=1)

    def _friction(self, index: int, rows: FloatArray) -> FloatArray:
        """λ_T as the solver found it; a drive without a bound to speak of has none."""
        return np.where(self.lanes[index].chain.friction_bound > 0, rows * self._units[index].force, 0.0)

    def _normal_force(self, index: int, rows: FloatArray, given: FloatArray) -> FloatArray:
        """λ_N as the solver found it in contacts."""
        return given if rows.shape[-1] == 0 else rows * self._units[index].force


class NewtonLane(LaneModel):
    """One lane alone: in SI units, time steps differ."""

    def __init__(self, lane: Lane, formulation: Formulation, preset: Preset):
        """Make its world."""
        self.lane = lane
        self._simulation = NewtonSimulation([lane], formulation, preset)

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state` at step index `start`."""
        return self._simulation.run(state, start, steps)[0]

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance as `run` does, and keep the end only."""
        return self._simulation.advance(state, start, steps)

    def native_steps(self, steps: int) -> None:
        """Take steps of the engine alone."""
        self._simulation.native_steps(steps)


def _worlds(lanes: Sequence[Lane], units: Sequence[Units], formulation: Formulation, preset: Preset) -> NewtonWorlds:
    """Make the worlds of lanes that share time step and size in their units."""
    chains = [unit.scaled(lane.chain) for lane, unit in zip(lanes, units, strict=True)]
    time_step = lanes[0].time_step / units[0].time
    if formulation is Formulation.JOINT:
        return JointWorlds(chains, time_step, preset)
    return ContactWorlds(chains, time_step, preset, PressedBoxes.of(lanes[0], units[0]).box)
