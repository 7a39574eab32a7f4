"""Scenes as users of MJX write them: MuJoCo's models of joints, stepped by a compiled loop."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from engines.interface.scene import ArmScene, JointScene, SceneSetting, Vector, not_launched
from engines.mjx.worlds import import_mjx
from engines.mujoco.scene import joint_world
from engines.shared.worlds import CHUNK
from reference_lcp.validation import FloatArray


@dataclass
class JointWorld:
    """One world with joints."""

    model: Any
    data: Any
    compiled: Any

    def run(self, steps: int) -> FloatArray:
        """Take steps; gives the coordinates, a row a step."""
        chunks = []
        while steps > 0:
            count = min(steps, CHUNK)
            self.data, rows = self.compiled.followed(self.model, self.data, count)
            chunks.append(np.array(rows[:count]))
            steps -= count
        return np.concatenate(chunks)

    def launch(self, velocity: Vector, spin: float) -> None:
        """Refuse: there is no box."""
        not_launched(velocity, spin)

    def close(self) -> None:
        """Do nothing: memory is JAX's."""


def joints(scene: JointScene | ArmScene, setting: SceneSetting) -> JointWorld:
    """Build a scene with joints, and compile its steps."""
    compiled = import_mjx()
    from mujoco import mjx

    model, start = joint_world(scene, setting)
    world = JointWorld(mjx.put_model(model), mjx.put_data(model, start), compiled)
    compiled.followed(world.model, world.data, 0)
    return world
