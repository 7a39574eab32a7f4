"""Scenes of SAPIEN, how lanes of both formulations are loaded and read, and their units."""

import functools
import importlib
import warnings
from typing import Any

import numpy as np

from engines.interface.presets import Option, Preset
from engines.shared.force_loop import ExplicitForcesLane
from engines.shared.units import Units
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray

SOLVER_ITERATIONS = Option(10, 10, "SAPIEN's own: each of the temporal solver is a substep.")
VELOCITY_ITERATIONS = Option(1, 1, "SAPIEN's own: velocities are corrected once more after positions have moved.")

SINGLE = 2.0**-24
"""Largest rounding of one operation, as a part of its result."""

ROUNDINGS = 8
"""Of a velocity in a step: two in storing it before and after, the others in adding impulses."""


class SapienLane(ExplicitForcesLane):
    """One chain; a run makes its scene anew, for contacts keep where they stuck.

    PhysX tells no friction, neither of contacts nor of drives: it is read from the momentum of the inner masses.
    """

    def __init__(self, lane: Lane, preset: Preset, units: Units):
        """Take the lane's parameters in `units`."""
        super().__init__(lane, units)
        self._preset = preset
        # Force on a mass over its mass and velocity, by which PhysX slows it down.
        self._drag = 0.0

    def _new_scene(self) -> tuple[Any, Any]:
        """Make an empty scene, kept until the next one is made; gives it, and the system that steps it."""
        sapien = import_sapien()
        physx, preset = sapien.physx, self._preset
        # Configurations are global, and copied by what is made next.
        physx.set_scene_config(gravity=np.zeros(3), enable_tgs=preset["enable_tgs"])
        physx.set_body_config(
            solver_position_iterations=preset["solver_position_iterations"],
            solver_velocity_iterations=preset["solver_velocity_iterations"],
            sleep_threshold=0.0,
        )
        system = physx.PhysxCpuSystem()
        system.timestep = self._time_step
        # Bodies do not keep their scene: without it they are gone, and to use them ends the process.
        self._scene = sapien.Scene([system])
        return self._scene, system

    def _contacts(self) -> FloatArray:
        """Read nothing: friction is in the motion."""
        return np.empty(0)

    def _contact_forces(
        self, read: FloatArray, motions: FloatArray, given: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        cells, units = self._chain.cells, self._units
        outer, inner = np.split(self.coordinates.absolute(motions[:, 2 * cells :]), 2, axis=1)
        rate = self._chain.inner_mass / self._time_step
        # The force of the coordinates of inner masses is the force on these, whatever carries them.
        force = motions[:-1] @ self._forces[cells:].T - self._drag * self._chain.inner_mass * inner[:-1]
        friction = rate * np.diff(inner, axis=0) - force
        bound = self._chain.friction_coefficient * given / units.force
        speed = np.maximum(np.abs(outer), np.abs(inner))
        rounding = ROUNDINGS * SINGLE * (rate * (speed[:-1] + speed[1:]) + np.abs(force))
        at_bound = np.abs(friction) > bound - rounding
        return np.where(at_bound, np.copysign(bound, friction), friction) * units.force, given


@functools.cache
def import_sapien() -> Any:
    """Import SAPIEN, without its warnings that there is nothing to draw with, and with what it logs left to errors."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        sapien = importlib.import_module("sapien")
    sapien.set_log_level("error")
    return sapien
