"""A box that is spun about the vertical, and stops by the torque of its friction."""

import math
from collections.abc import Mapping

import numpy as np

from multibody_xval.engines.interface.scene import GRAVITY, Box, ContactScene
from multibody_xval.scenarios.catalogue.scenes.base import Measured, SceneCase, SceneScenario
from multibody_xval.scenarios.catalogue.scenes.slide import FRICTION_RESOLUTION, LIFT, LIFT_RESOLUTION, REST, WHOLE
from multibody_xval.scenarios.runs.result import NamedNumbers
from multibody_xval.scenarios.runs.scene import SceneTask
from multibody_xval.scenarios.verdicts.finding import Metric

CORNERS = math.sqrt(0.5)
"""Lever of friction over the side of the box, if its corners carry it: a torque of μ m g times that."""

UNIFORM = (math.sqrt(2) + math.asinh(1)) / 6
"""The same under a uniform pressure: the mean distance from the centre of a square."""

TORQUE = Metric(
    "torque", "%", "Mean torque of friction of a spinning box over that at its corners, less 1.", effect=WHOLE
)
WANDER = Metric("wander", "mm", "Way of the centre of a box that is spun.")

WANDER_RESOLUTION = 0.1
"""Way of its centre that counts as none [mm]: a thousandth of half its side."""


def _spun(spin: float, friction: float = 0.5, box: Box | None = None) -> SceneCase:
    """Give a box on the flat that is spun [rad/s], with the time that it takes under a uniform pressure, and a rest."""
    scene = ContactScene(friction=friction, boxes=(box or Box(),))
    time = 1.5 * spin / braking(scene, UNIFORM) + REST
    return SceneCase(name=f"{spin:g} rad/s", scene=scene, time=time, spin=spin)


def braking(scene: ContactScene, lever: float) -> float:
    """Give the angular deceleration [rad/s²]: of a cube of side s, μ m g times the lever over m s² / 6."""
    return 6 * scene.friction * GRAVITY * lever / scene.boxes[0].side


class Spin(SceneScenario):
    """A box that is spun stops by a torque between those of a uniform pressure and of its corners, on its place."""

    name = "spin"
    metrics = (TORQUE, WANDER, LIFT)
    cases = (_spun(20.0),)
    held_out = (_spun(15.0, 0.3, Box(mass=5.0, side=0.3)),)

    def numbers(self, case: SceneCase, task: SceneTask, series: NamedNumbers) -> Mapping[Metric, Measured]:
        """Read the torque from the angle to the stop; any that a pressure of one sign can make is expected."""
        scene = task.scene
        assert isinstance(scene, ContactScene), "a box is spun"
        slowing = braking(scene, CORNERS)
        turned = abs(float(np.unwrap([0.0, *series["turn"]])[-1]))
        torque = 100 * (task.spin**2 / (2 * slowing * turned) - 1) if turned else math.inf
        step = 100 * slowing * task.time_step / task.spin  # half a step's turn, at either end
        way = 1e3 * math.hypot(series["along"][-1], series["across"][-1])
        return {
            TORQUE: Measured(torque, min(max(torque, 100 * (UNIFORM / CORNERS - 1)), 0.0), FRICTION_RESOLUTION, step),
            WANDER: Measured(way, 0.0, WANDER_RESOLUTION),
            LIFT: Measured(1e3 * max(0.0, series["highest"][-1]), 0.0, LIFT_RESOLUTION),
        }
