"""A box at rest that is pushed a little harder than friction holds it, straight on or at an angle to the axes."""

import math

import numpy as np

from multibody_xval.engines.interface.scene import GRAVITY, Box, ContactScene
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.catalogue.scenario import Scenario, scene_steps
from multibody_xval.scenarios.catalogue.scenes.scene import NONE, SOURCE, box_scene, watched
from multibody_xval.scenarios.catalogue.scenes.sliding_boxes import QUARTER, in_percent, in_plane
from multibody_xval.scenarios.model import AnyCase, Result, Run

LOADS = (1.2, 1.06)
"""Pushes over μ m g: the nearer to one, the more a small error of friction moves the box."""

BOX = Box(side=0.1, length=0.2)
"""So low that a push at its centre hardly tips it."""

ANGLES = (0, 15, 30, 45)
"""Of box and push to the world's axes [°]."""


def from_rest(load: float, degrees: float, friction: float = 0.5, box: Box = BOX) -> SceneMotion:
    """Give a box on the flat, turned by so many degrees, that is pushed along its own x axis with load · μ m g."""
    scene = ContactScene(friction=friction, turn=math.radians(degrees), boxes=(box,))
    return watched(scene, QUARTER, push=load * friction * box.mass * GRAVITY)


def excess(case: AnyCase) -> float:
    """Give by how much the push is more than friction, over friction."""
    scene = box_scene(case)
    assert isinstance(case, SceneMotion), "a scene"
    return case.push / (scene.friction * scene.boxes[0].mass * GRAVITY) - 1


def way_pushed(case: SceneMotion) -> float:
    """Give a t² / 2, with a = (load − 1) μ g [m]."""
    return excess(case) * box_scene(case).friction * GRAVITY * case.time**2 / 2


def way(result: Result, run: Run) -> float:
    """Read how far from its exact place a box is, over the exact way [%]."""
    case = run.of(SceneMotion)
    straight = np.array(box_scene(case).forward[:2])
    return 100 * float(np.linalg.norm(in_plane(result)[-1] / way_pushed(case) - straight))


PUSHED_FROM_REST = Scenario(
    name="pushed-from-rest",
    question="How far does a box at rest go that is pushed a little harder than friction holds it, in any direction?",
    expects="closed form: (load − 1) μ g t²/2 along the push; allowed: what a step of semi-implicit Euler moves a body",
    source=SOURCE,
    cases={f"{load:g} μmg, {angle}°": from_rest(load, angle) for load in LOADS for angle in ANGLES},
    held_out={"1.5 μmg, 20°, 5 kg": from_rest(1.5, 20, 0.3, Box(mass=5.0, side=0.2, length=0.3))},
    quantities=(
        in_percent(
            name="way", read=way, step_error=lambda run: 100 / run.steps,
            resolution=lambda run: NONE["friction"] / excess(run.case), effect=lambda case, _: 100 / excess(case),
            meaning="Distance of a pushed box from where it should be after 0.25 s, sideways too, over its exact way.",
        ),
    ),
    steps=scene_steps,
)  # fmt: skip

SCENARIOS = (PUSHED_FROM_REST,)
