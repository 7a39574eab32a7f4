"""Boxes that friction holds: on a slope, in stacks, between fingers."""

import math
from dataclasses import replace

import numpy as np

from multibody_xval.engines.interface.scene import Box, ContactScene
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.catalogue.scenario import Scenario, at_rest, scene_steps
from multibody_xval.scenarios.catalogue.scenes.scene import (
    HOLDING,
    NONE,
    SOURCE,
    box_scene,
    no_drift,
    watched,
)
from multibody_xval.scenarios.model import Result, Run


def in_the_plane(run: Run) -> tuple[int, int]:
    """Give the two axes of the plane that holds a box, of along, across and off."""
    return (2, 1) if box_scene(run.case).grip else (0, 1)


def drift(result: Result, run: Run) -> float:
    """Give the mean velocity in the plane [µm/s]."""
    ways = [result.series[("along", "across", "off")[axis]][-1] for axis in in_the_plane(run)]
    return 1e6 * float(np.linalg.norm(ways)) / run.of(SceneMotion).time


def sag(result: Result, run: Run) -> float:
    """Give the way in the plane since the scene was built [mm]."""
    return 1e3 * float(np.linalg.norm([result.series["from the start"][axis] for axis in in_the_plane(run)]))


DRIFT = at_rest(
    name="drift", unit="µm/s", read=drift, resolution=no_drift, accuracy="drift",
    meaning=f"Mean velocity over {HOLDING:g} s of a box that friction should hold.",
)  # fmt: skip

HELD = (
    DRIFT,
    at_rest(
        name="sag", unit="mm", read=sag, resolution=NONE["sag"],
        meaning="Way of a box that friction should hold since the scene was built.",
    ),
)  # fmt: skip


def on_slope(load: float, *, friction: float = 0.5, turn: float = 0.0, box: Box | None = None) -> ContactScene:
    """Give a box on a slope whose tangent is a part of the coefficient of friction."""
    return ContactScene(friction=friction, slope=math.atan(load * friction), turn=turn, boxes=(box or Box(),))


TURN = 0.5
"""Of boxes that do not lie along the slope [rad]."""

SLOPE_HOLD = Scenario(
    name="slope-hold",
    question="Does a box stay where it is on a slope below the critical one, as the engine's users build it?",
    expects="no motion",
    source=SOURCE,
    cases={
        **{f"load {load:g}": watched(on_slope(load)) for load in (0.1, 0.5, 0.9)},
        **{f"load {load:g}, turned": watched(on_slope(load, turn=TURN)) for load in (0.5, 0.9)},
        "load 0.5, 1 g": watched(on_slope(0.5, box=Box(mass=1e-3, side=0.1))),
        "load 0.5, 1 t": watched(on_slope(0.5, box=Box(mass=1e3, side=1.0))),
        "load 0.9, may sleep": watched(on_slope(0.9), sleeping=True),
    },
    held_out={
        "load 0.8, turned, 0.3 kg": watched(on_slope(0.8, friction=0.8, turn=0.3, box=Box(mass=0.3, side=0.1))),
        "load 0.7, 20 kg": watched(on_slope(0.7, friction=0.3, box=Box(mass=20.0, side=0.4))),
    },
    quantities=HELD,
    steps=scene_steps,
)

STACK_SLOPE = math.radians(12)
"""Its tangent is 0.43 of the coefficient of friction."""

STACK_HOLD = replace(
    SLOPE_HOLD,
    name="stack-hold",
    question="Does a stack of boxes stay where it is on a slope?",
    cases={"3 boxes, 12°": watched(ContactScene(slope=STACK_SLOPE, boxes=(Box(),) * 3))},
    held_out={"4 boxes, 8°": watched(ContactScene(slope=math.radians(8), boxes=(Box(mass=2.0, side=0.14),) * 4))},
)

HEAVY_ON_LIGHT = replace(
    SLOPE_HOLD,
    name="heavy-on-light",
    question="Does a heavy box stay where it is on a light one, on a slope?",
    cases={"100 kg on 1 kg, 12°": watched(ContactScene(slope=STACK_SLOPE, boxes=(Box(), Box(mass=100.0))))},
    held_out={"30 kg on 1 kg, 8°": watched(ContactScene(slope=math.radians(8), boxes=(Box(), Box(mass=30.0))))},
)

GRIP = replace(
    SLOPE_HOLD,
    name="grip",
    question="Do two fingers hold a box that they press?",
    cases={
        f"1 kg, {force:g} N": watched(ContactScene(grip=force, boxes=(Box(side=0.1),))) for force in (10.0, 15.0, 30.0)
    },
    held_out={"2 kg, 25 N": watched(ContactScene(grip=25.0, boxes=(Box(mass=2.0, side=0.08),)))},
)

SCENARIOS = (SLOPE_HOLD, STACK_HOLD, HEAVY_ON_LIGHT, GRIP)
