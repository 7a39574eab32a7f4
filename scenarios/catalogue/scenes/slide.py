"""Boxes that slide: down a slope, on the flat until they stop, on a belt until they move with it."""

import math
from collections.abc import Mapping

import numpy as np

from multibody_xval.engines.interface.scene import GRAVITY, Box, ContactScene, Vector
from multibody_xval.scenarios.catalogue.scenes.base import (
    CREEP_RESOLUTION,
    Measured,
    SceneCase,
    SceneScenario,
    round_off,
)
from multibody_xval.scenarios.catalogue.scenes.hold import on_slope
from multibody_xval.scenarios.runs.result import NamedNumbers
from multibody_xval.scenarios.runs.scene import SceneTask
from multibody_xval.scenarios.verdicts.finding import Metric
from reference_lcp.validation import FloatArray

SLIDING = 2.0
"""How long a box slides down [s]."""

FRICTION_RESOLUTION = 0.1
"""Error of friction that counts as none [%], and with it of distances and times: a tenth of what has to be found."""

LIFT_RESOLUTION = 0.1
"""Lift that counts as none [mm]: a thousandth of half the side of a box."""

TURN_RESOLUTION = 0.1
"""Turn that counts as none [°]: 2 mm on a way of 1 m."""

REST = 1.0
"""How long a box is watched after it has stopped [s]."""

BELT = 1.0
"""Velocity of a belt [m/s]."""

REACHED = 0.98
"""Part of the belt's velocity at which a box counts as moving with it."""

WHOLE = 100.0
"""Size of what is expected, in numbers over it, less 1 [%]."""

FRICTION = Metric("friction", "%", "Mean friction of a sliding box over μ N, less 1.", effect=WHOLE)
DISTANCE = Metric("distance", "%", "Way of a box to its stop over v²/(2 μ g), less 1.", effect=WHOLE)
LIFT = Metric("lift", "mm", "Largest height of a sliding box above its place.")
PATH = Metric("path", "°", "Angle between the way of a sliding box and its first velocity.")
YAW = Metric("yaw", "°", "By how much a box has turned about the vertical when it stops.")
DRIFT = Metric("drift", "µm/s", f"Mean velocity over {REST:g} s after the stop.")
DELAY = Metric(
    "time", "%", f"Time to {REACHED:g} of the belt's velocity over that of Coulomb's law, less 1.", effect=WHOLE
)


class SlopeSlide(SceneScenario):
    """A box slides down a slope above the critical one with g (sin θ − μ cos θ)."""

    name = "slope-slide"
    metrics = (FRICTION,)
    cases = tuple(
        SceneCase(name=f"μ {friction:g}, load {load:g}", scene=on_slope(load, friction=friction), time=SLIDING)
        for friction in (0.2, 0.5, 0.8)
        for load in (1.2, 1.5, 3.0)
    )
    held_out = (
        SceneCase(name="μ 0.3, load 1.3, 5 kg", scene=on_slope(1.3, friction=0.3, box=Box(mass=5.0)), time=SLIDING),
    )

    def numbers(self, case: SceneCase, task: SceneTask, series: NamedNumbers) -> Mapping[Metric, Measured]:
        """Read the friction from the acceleration between the first row and the last."""
        scene = task.scene
        assert isinstance(scene, ContactScene), "a box slides"
        time, speed = np.array(series["time"]), np.array(series["speed along"])
        acceleration = (speed[-1] - speed[0]) / (time[-1] - time[0])
        bound = scene.friction * GRAVITY * math.cos(scene.slope)
        friction = (GRAVITY * math.sin(scene.slope) - acceleration) / bound
        return {FRICTION: Measured(100 * (float(friction) - 1), 0.0, FRICTION_RESOLUTION)}


def launched(speed: float, direction: float = 0.0, *, friction: float = 0.5, box: Box | None = None) -> SceneCase:
    """Give a box on the flat that is launched, with a direction off the x axis [rad]."""
    velocity: Vector = (speed * math.cos(direction), speed * math.sin(direction), 0.0)
    aside = f", {math.degrees(direction):.0f}° off" if direction else ""
    scene = ContactScene(friction=friction, boxes=(box or Box(),))
    return SceneCase(name=f"{speed:g} m/s{aside}", scene=scene, time=_stopped(speed, friction) + REST, launch=velocity)


def _stopped(speed: float, friction: float) -> float:
    """Give a time at which a box has stopped, also with a third less friction [s]."""
    return 1.5 * speed / (friction * GRAVITY) + 0.3


class SlideToStop(SceneScenario):
    """A box that is launched on the flat stops after v²/(2 μ g), on its straight way, and stays there."""

    name = "slide-to-stop"
    metrics = (DISTANCE, LIFT, PATH, YAW, DRIFT)
    cases = (*(launched(speed) for speed in (1.0, 3.0, 6.0)), launched(3.0, math.radians(30)))
    held_out = (launched(2.0, math.radians(20), friction=0.3, box=Box(mass=5.0, side=0.3)),)

    def numbers(self, case: SceneCase, task: SceneTask, series: NamedNumbers) -> Mapping[Metric, Measured]:
        """Read the way to the stop, and what the box does beside sliding."""
        scene = task.scene
        assert isinstance(scene, ContactScene), "a box slides"
        time, along, across = (np.array(series[name]) for name in ("time", "along", "across"))
        stop = int(np.searchsorted(time, task.time - REST))
        speed = math.hypot(*task.launch)
        distance = speed**2 / (2 * scene.friction * GRAVITY)
        direction = math.degrees(math.atan2(across[stop], along[stop]) - math.atan2(task.launch[1], task.launch[0]))
        drift = math.hypot(along[-1] - along[stop], across[-1] - across[stop]) / (time[-1] - time[stop])
        part = scene.friction * GRAVITY * task.time_step / speed
        step = 100 * part * (1 + part / 4)  # half a step's way, and what is left of the last step
        round_off_of_drift = 1e6 * round_off(task, distance) / REST
        return {
            DISTANCE: _in_percent(math.hypot(along[stop], across[stop]) / distance, step),
            LIFT: Measured(1e3 * max(0.0, series["highest"][stop]), 0.0, LIFT_RESOLUTION),
            PATH: Measured(math.remainder(direction, 360), 0.0, TURN_RESOLUTION),
            YAW: Measured(math.degrees(series["turn"][stop]), 0.0, TURN_RESOLUTION),
            DRIFT: Measured(1e6 * drift, 0.0, CREEP_RESOLUTION + round_off_of_drift),
        }


def _in_percent(ratio: float, own_step: float) -> Measured:
    """Give by how much a ratio is not 1 [%]; a step of semi-implicit Euler has an error of its own."""
    return Measured(100 * (ratio - 1), 0.0, FRICTION_RESOLUTION, own_step)


def _belt(speed: float, friction: float = 0.5, box: Box | None = None) -> SceneCase:
    scene = ContactScene(friction=friction, belt=speed, boxes=(box or Box(),))
    return SceneCase(name=f"{speed:g} m/s, μ {friction:g}", scene=scene, time=_stopped(speed, friction), settling=0.0)


class Conveyor(SceneScenario):
    """A box that is put on a belt moves with it after v/(μ g)."""

    name = "conveyor"
    metrics = (DELAY,)
    cases = (_belt(BELT),)
    held_out = (_belt(0.7, 0.3, Box(mass=5.0)),)

    def numbers(self, case: SceneCase, task: SceneTask, series: NamedNumbers) -> Mapping[Metric, Measured]:
        """Read when the box moves with the belt: never, if it does not within half as long again."""
        scene = task.scene
        assert isinstance(scene, ContactScene), "a box lies on a belt"
        aim = REACHED * scene.belt
        expected = aim / (scene.friction * GRAVITY)
        time, speed = np.array([0.0, *series["time"]]), np.array([0.0, *series["speed along"]])
        own_step = 100 * task.time_step / expected
        return {DELAY: _in_percent(_first_time(time, speed, aim) / expected, own_step)}


def _first_time(time: FloatArray, speed: FloatArray, aim: float) -> float:
    """Give when a speed first reaches an aim, between rows too [s]; infinite if it never does."""
    reached = np.flatnonzero(speed >= aim)
    if reached.size == 0:
        return math.inf
    last = int(reached[0])
    return float(np.interp(aim, speed[last - 1 : last + 1], time[last - 1 : last + 1]))
