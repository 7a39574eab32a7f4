"""Scenes of SAPIEN, what both formulations have in common."""

import functools
import importlib
import warnings
from typing import Any

import numpy as np

from engines.interface.presets import Option, Preset
from engines.shared.force_loop import ExplicitForcesLane
from engines.shared.units import Units
from reference_lcp.chain.simulation import Lane

SOLVER_ITERATIONS = Option(10, 10, "SAPIEN's own: each of the temporal solver is a substep.")
VELOCITY_ITERATIONS = Option(1, 1, "SAPIEN's own: velocities are corrected once more after positions have moved.")


class SapienLane(ExplicitForcesLane):
    """One chain; a run makes its scene anew, for contacts keep where they stuck."""

    def __init__(self, lane: Lane, preset: Preset, units: Units):
        """Take the lane's parameters in `units`."""
        super().__init__(lane, units)
        self._preset = preset

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


@functools.cache
def import_sapien() -> Any:
    """Import SAPIEN, without its warnings that there is nothing to draw with, and with what it logs left to errors."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        sapien = importlib.import_module("sapien")
    sapien.set_log_level("error")
    return sapien
