"""Boxes that slide: down a slope, on the flat until they stop, on a belt until they move with it."""

import math
from functools import partial

import numpy as np

from multibody_xval.engines.interface.scene import GRAVITY, Box, ContactScene, Vector
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.catalogue.scenario import Quantity, Scenario, at_rest, scene_steps
from multibody_xval.scenarios.catalogue.scenes.held_boxes import on_slope
from multibody_xval.scenarios.catalogue.scenes.scene import (
    NONE,
    SOURCE,
    box_scene,
    no_drift,
    time_step,
    watched,
)
from multibody_xval.scenarios.model import AnyCase, Result, Run
from reference_lcp.validation import FloatArray

SLIDING = 2.0
"""How long a box slides down [s]."""

REST = 1.0
"""How long a box is watched after it has stopped [s]."""

QUARTER = 0.25
"""Motions take whole ones [s]: every engine's own time step then fits into them as it is."""

BELT = 1.0
"""Velocity of a belt [m/s]."""

ON_BELT = 0.4
"""How long a box is watched on a belt [s]: about twice as long as it needs, and so short that speeds are kept often
enough to be read between rows."""

REACHED = 0.98
"""Part of the belt's velocity at which a box counts as moving with it."""

in_percent = partial(Quantity, unit="%", exact=0.0, resolution=NONE["friction"], effect=100.0, accuracy="share")
"""By how much a number is off, of what friction does."""


def in_quarters(time: float) -> float:
    """Give the next larger number of whole quarters of a second [s]."""
    return math.ceil(time / QUARTER) * QUARTER


def deceleration(case: AnyCase) -> float:
    """Give that of a box that slides on the flat, μ g [m/s²]."""
    return box_scene(case).friction * GRAVITY


def friction_of_slide(result: Result, run: Run) -> float:
    """Read the friction from the acceleration between the first row and the last."""
    scene = box_scene(run.case)
    time, speed = result.series["time"], result.series["speed along"]
    acceleration = (speed[-1] - speed[0]) / (time[-1] - time[0])
    bound = scene.friction * GRAVITY * math.cos(scene.slope)
    return 100 * ((GRAVITY * math.sin(scene.slope) - acceleration) / bound - 1)


SLOPE_SLIDE = Scenario(
    name="slope-slide",
    question="How much friction does a box meet that slides down a slope?",
    expects="closed form: a = g (sin θ − μ cos θ)",
    source=SOURCE,
    cases={
        f"μ {friction:g}, load {load:g}": watched(on_slope(load, friction=friction), SLIDING)
        for friction in (0.2, 0.5, 0.8)
        for load in (1.2, 1.5, 3.0)
    },
    held_out={"μ 0.3, load 1.3, 5 kg": watched(on_slope(1.3, friction=0.3, box=Box(mass=5.0)), SLIDING)},
    quantities=(
        in_percent(
            name="friction", read=friction_of_slide, step_error=0.0,
            meaning="Mean friction of a sliding box over μ N, less 1.",
        ),
    ),
    steps=scene_steps,
)  # fmt: skip


def launched(speed: float, degrees: float = 0.0, *, friction: float = 0.5, box: Box | None = None) -> SceneMotion:
    """Give a box on the flat that is launched with a speed [m/s], so many degrees off the x axis."""
    direction = math.radians(degrees)
    velocity: Vector = (speed * math.cos(direction), speed * math.sin(direction), 0.0)
    scene = ContactScene(friction=friction, boxes=(box or Box(),))
    stopped = 1.5 * speed / (friction * GRAVITY) + 0.3  # also with a third less friction
    return watched(scene, in_quarters(stopped + REST), launch=velocity)


def launch_speed(case: SceneMotion) -> float:
    """Give the speed with which a box is launched [m/s]."""
    return math.hypot(*case.launch)


def way_to_stop(case: SceneMotion) -> float:
    """Give v²/(2 μ g) [m]."""
    return launch_speed(case) ** 2 / (2 * deceleration(case))


def stop_row(result: Result, run: Run) -> int:
    """Give the row at which a box is to have stopped, before its rest is watched."""
    return int(np.searchsorted(result.series["time"], run.of(SceneMotion).time - REST))


def in_plane(result: Result) -> FloatArray:
    """Give the way along and across; shape (rows, 2)."""
    return np.column_stack([result.series["along"], result.series["across"]])


def distance(result: Result, run: Run) -> float:
    """Read the way to the stop over the exact one, less 1 [%]."""
    way = float(np.linalg.norm(in_plane(result)[stop_row(result, run)]))
    return 100 * (way / way_to_stop(run.of(SceneMotion)) - 1)


def distance_step_error(run: Run) -> float:
    """Give half a step's way, and what is left of the last step [%]."""
    part = deceleration(run.case) * time_step(run) / launch_speed(run.of(SceneMotion))
    return 100 * part * (1 + part / 4)


def path(result: Result, run: Run) -> float:
    """Read the angle between way and launch [°]."""
    along, across = in_plane(result)[stop_row(result, run)]
    launch = run.of(SceneMotion).launch
    return math.remainder(math.degrees(math.atan2(across, along) - math.atan2(launch[1], launch[0])), 360)


def drift_after_stop(result: Result, run: Run) -> float:
    """Read the mean velocity after the stop [µm/s]."""
    way, time, stop = in_plane(result), result.series["time"], stop_row(result, run)
    return 1e6 * float(np.linalg.norm(way[-1] - way[stop])) / (time[-1] - time[stop])


SLIDE_TO_STOP = Scenario(
    name="slide-to-stop",
    question="How far does a box slide on the flat, straight and without hopping, and does it stay where it stops?",
    expects="closed form: v²/(2 μ g); allowed: what a step of semi-implicit Euler moves a body",
    source=SOURCE,
    cases={
        **{f"{speed:g} m/s": launched(speed) for speed in (1.0, 3.0, 6.0)},
        "3 m/s, 30° off": launched(3.0, 30),
    },
    held_out={"2 m/s, 20° off": launched(2.0, 20, friction=0.3, box=Box(mass=5.0, side=0.3))},
    quantities=(
        in_percent(
            name="distance", read=distance, step_error=distance_step_error,
            meaning="Way of a box to its stop over v²/(2 μ g), less 1.",
        ),
        at_rest(
            name="lift", unit="mm", resolution=NONE["lift"],
            read=lambda result, run: 1e3 * max(0.0, result.series["highest"][stop_row(result, run)]),
            meaning="Largest height of a sliding box above its place.",
        ),
        at_rest(
            name="path", unit="°", read=path, resolution=NONE["turn"],
            meaning="Angle between the way of a sliding box and its first velocity.",
        ),
        at_rest(
            name="yaw", unit="°", resolution=NONE["turn"],
            read=lambda result, run: math.degrees(result.series["turn"][stop_row(result, run)]),
            meaning="By how much a box has turned about the vertical when it stops.",
        ),
        at_rest(
            name="drift", unit="µm/s", read=drift_after_stop, accuracy="drift",
            resolution=lambda run: no_drift(run, way_to_stop(run.of(SceneMotion)), REST),
            meaning=f"Mean velocity over {REST:g} s after the stop.",
        ),
    ),
    steps=scene_steps,
)  # fmt: skip


def on_belt(speed: float, friction: float = 0.5, box: Box | None = None) -> SceneMotion:
    """Give a box that is put on a belt with this velocity [m/s]."""
    return SceneMotion(scene=ContactScene(friction=friction, belt=speed, boxes=(box or Box(),)), time=ON_BELT)


def time_with_belt(case: AnyCase) -> float:
    """Give the time at which a box moves with the belt, by Coulomb's law [s]."""
    return REACHED * box_scene(case).belt / deceleration(case)


def delay(result: Result, run: Run) -> float:
    """Read when a box moves with the belt, over when it is to, less 1 [%]; infinite if it never does."""
    time, speed = (np.array([0.0, *result.series[name]]) for name in ("time", "speed along"))
    return 100 * (first_time(time, speed, REACHED * box_scene(run.case).belt) / time_with_belt(run.case) - 1)


def first_time(time: FloatArray, speed: FloatArray, aim: float) -> float:
    """Give when a speed first reaches an aim, between rows too [s]; infinite if it never does."""
    reached = np.flatnonzero(speed >= aim)
    if reached.size == 0:
        return math.inf
    last = int(reached[0])
    return float(np.interp(aim, speed[last - 1 : last + 1], time[last - 1 : last + 1]))


CONVEYOR = Scenario(
    name="conveyor",
    question="When does a box that is put on a belt move with it?",
    expects="closed form: v/(μ g); allowed: what a step of semi-implicit Euler moves a body",
    source=SOURCE,
    cases={f"{BELT:g} m/s, μ 0.5": on_belt(BELT)},
    held_out={"0.7 m/s, μ 0.3": on_belt(0.7, 0.3, Box(mass=5.0))},
    quantities=(
        in_percent(
            name="time", read=delay, step_error=lambda run: 100 * time_step(run) / time_with_belt(run.case),
            meaning=f"Time to {REACHED:g} of the belt's velocity over that of Coulomb's law, less 1.",
        ),
    ),
    steps=scene_steps,
)  # fmt: skip

SCENARIOS = (SLOPE_SLIDE, SLIDE_TO_STOP, CONVEYOR)
