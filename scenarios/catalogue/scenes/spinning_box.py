"""A box that is spun about the vertical, and stops by the torque of its friction."""

import math

import numpy as np

from multibody_xval.engines.interface.scene import GRAVITY, Box, ContactScene
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.catalogue.scenario import Scenario, at_rest, scene_steps
from multibody_xval.scenarios.catalogue.scenes.scene import NONE, SOURCE, box_scene, time_step, watched
from multibody_xval.scenarios.catalogue.scenes.sliding_boxes import REST, in_percent, in_quarters
from multibody_xval.scenarios.model import Result, Run

CORNERS = math.sqrt(0.5)
"""Lever of friction over the side of the box, if its corners carry it: a torque of μ m g times that."""

UNIFORM = (math.sqrt(2) + math.asinh(1)) / 6
"""The same under a uniform pressure: the mean distance from the centre of a square."""


def braking(scene: ContactScene, lever: float) -> float:
    """Give the angular deceleration [rad/s²]: of a cube of side s, μ m g times the lever over m s² / 6."""
    return 6 * scene.friction * GRAVITY * lever / scene.boxes[0].side


def spun(spin: float, friction: float = 0.5, box: Box | None = None) -> SceneMotion:
    """Give a box on the flat that is spun [rad/s], with the time that it takes under a uniform pressure, and a rest."""
    scene = ContactScene(friction=friction, boxes=(box or Box(),))
    time = in_quarters(1.5 * spin / braking(scene, UNIFORM) + REST)
    return watched(scene, time, spin=spin)


def torque(result: Result, run: Run) -> float:
    """Read the torque from the angle to the stop, over that at the corners, less 1 [%]."""
    turned = abs(float(np.unwrap([0.0, *result.series["turn"]])[-1]))
    spin = run.of(SceneMotion).spin
    return 100 * (spin**2 / (2 * braking(box_scene(run.case), CORNERS) * turned) - 1) if turned else math.inf


def torque_step_error(run: Run) -> float:
    """Give half a step's turn at either end [%]."""
    return 100 * braking(box_scene(run.case), CORNERS) * time_step(run) / run.of(SceneMotion).spin


SPIN = Scenario(
    name="spin",
    question="Does a box that is spun on the flat stop on its place, by a torque that friction can have?",
    expects="limits: from that of a uniform pressure to μ m g s/√2, that of the corners; allowed: what a step of "
    "semi-implicit Euler moves a body",
    source=SOURCE,
    cases={"20 rad/s": spun(20.0)},
    held_out={"15 rad/s": spun(15.0, 0.3, Box(mass=5.0, side=0.3))},
    quantities=(
        in_percent(
            name="torque", read=torque, step_error=torque_step_error, between=(100 * (UNIFORM / CORNERS - 1), 0.0),
            meaning="Mean torque of friction of a spinning box over that at its corners, less 1.",
        ),
        at_rest(
            name="wander", unit="mm", resolution=NONE["wander"],
            read=lambda result, _run: 1e3 * math.hypot(result.series["along"][-1], result.series["across"][-1]),
            meaning="Way of the centre of a box that is spun.",
        ),
        at_rest(
            name="lift", unit="mm", resolution=NONE["lift"],
            read=lambda result, _run: 1e3 * max(0.0, result.series["highest"][-1]),
            meaning="Largest height of a spinning box above its place.",
        ),
    ),
    steps=scene_steps,
)  # fmt: skip

SCENARIOS = (SPIN,)
