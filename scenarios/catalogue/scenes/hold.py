"""Boxes that friction holds: on a slope, in a stack, under a heavy one, between two fingers."""

import math
from collections.abc import Mapping

import numpy as np

from multibody_xval.engines.interface.scene import Box, ContactScene
from multibody_xval.scenarios.catalogue.scenes.base import (
    CREEP,
    HOLDING,
    SAG,
    Measured,
    SceneCase,
    SceneScenario,
    creep,
    sag,
)
from multibody_xval.scenarios.runs.result import NamedNumbers
from multibody_xval.scenarios.runs.scene import SceneTask
from multibody_xval.scenarios.verdicts.finding import Metric

TURN = 0.5
"""Of boxes that do not lie along the slope [rad]."""

STACK_SLOPE = math.radians(12)
"""Its tangent is 0.43 of the coefficient of friction."""

HEAVY = 100.0
"""Of the upper box [kg]."""


def on_slope(load: float, *, friction: float = 0.5, turn: float = 0.0, box: Box | None = None) -> ContactScene:
    """Give a box on a slope whose tangent is a part of the coefficient of friction."""
    return ContactScene(friction=friction, slope=math.atan(load * friction), turn=turn, boxes=(box or Box(),))


class _Hold(SceneScenario):
    """The last box should not move."""

    metrics = (CREEP, SAG)

    def numbers(self, case: SceneCase, task: SceneTask, series: NamedNumbers) -> Mapping[Metric, Measured]:
        """Read the creep of the last box in the plane that holds it, and its way since the start."""
        along, across, off = series["from the start"]
        first, way = ("off", off) if isinstance(task.scene, ContactScene) and task.scene.grip else ("along", along)
        return {CREEP: creep(task, *(np.array(series[name]) for name in (first, "across"))), SAG: sag(way, across)}


def _case(name: str, scene: ContactScene, *, sleeping: bool = False) -> SceneCase:
    return SceneCase(name=name, scene=scene, time=HOLDING, sleeping=sleeping)


class SlopeHold(_Hold):
    """A box stays where it is on a slope below the critical one."""

    name = "slope-hold"
    cases = (
        *(_case(f"load {load:g}", on_slope(load)) for load in (0.1, 0.5, 0.9)),
        *(_case(f"load {load:g}, turned", on_slope(load, turn=TURN)) for load in (0.5, 0.9)),
        _case("load 0.5, 1 g", on_slope(0.5, box=Box(mass=1e-3, side=0.1))),
        _case("load 0.5, 1 t", on_slope(0.5, box=Box(mass=1e3, side=1.0))),
        _case("load 0.9, may sleep", on_slope(0.9), sleeping=True),
    )
    held_out = (
        _case("load 0.8, turned, 0.3 kg", on_slope(0.8, friction=0.8, turn=0.3, box=Box(mass=0.3, side=0.1))),
        _case("load 0.7, 20 kg", on_slope(0.7, friction=0.3, box=Box(mass=20.0, side=0.4))),
    )


class StackHold(_Hold):
    """Three boxes stay where they are, one on the other, on a slope."""

    name = "stack-hold"
    cases = (_case("3 boxes, 12°", ContactScene(slope=STACK_SLOPE, boxes=(Box(),) * 3)),)
    held_out = (_case("4 boxes, 8°", ContactScene(slope=math.radians(8), boxes=(Box(mass=2.0, side=0.14),) * 4)),)


class HeavyOnLight(_Hold):
    """A heavy box stays where it is on a light one, on a slope."""

    name = "heavy-on-light"
    cases = (_case("100 kg on 1 kg, 12°", ContactScene(slope=STACK_SLOPE, boxes=(Box(), Box(mass=HEAVY)))),)
    held_out = (_case("30 kg on 1 kg, 8°", ContactScene(slope=math.radians(8), boxes=(Box(), Box(mass=30.0)))),)


class Grip(_Hold):
    """A box stays between two fingers that press it."""

    name = "grip"
    cases = tuple(
        _case(f"1 kg, {force:g} N", ContactScene(grip=force, boxes=(Box(side=0.1),))) for force in (10.0, 15.0, 30.0)
    )
    held_out = (_case("2 kg, 25 N", ContactScene(grip=25.0, boxes=(Box(mass=2.0, side=0.08),))),)
