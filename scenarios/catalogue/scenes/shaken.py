"""Boxes that friction holds while they are shaken: by a force that swings, or by a mass inside that a force shakes."""

import math
from collections.abc import Mapping

import numpy as np

from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.scene import GRAVITY, Box, ContactScene, Shaker
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.scenes.base import (
    COMMON_STEP,
    CREEP,
    HOLDING,
    OWN_STEP,
    Measured,
    SceneCase,
    SceneScenario,
    creep,
)
from multibody_xval.scenarios.runs.result import NamedNumbers
from multibody_xval.scenarios.runs.scene import SceneTask, Tone
from multibody_xval.scenarios.verdicts.finding import Metric

STEPS = (COMMON_STEP, 0.0005, 0.002)
"""The first two that are not the engine's own come beside it [s]: whole periods have whole steps of each."""

FRICTION = 0.5

CASE = Box(side=0.1)
"""With a shaker inside [kg], [m]."""

Tones = tuple[tuple[float, int], ...]
"""Amplitudes and frequencies [Hz], whole ones: the box is then watched for whole periods."""


def pushed(name: str, load: float, tones: Tones, box: Box = Box()) -> SceneCase:  # noqa: B008
    """Give a box on a slope with this load, and tones of a force on it; all are parts of the bound of friction."""
    slope = math.atan(load * FRICTION)
    bound = FRICTION * box.mass * GRAVITY * math.cos(slope)
    shake = tuple(Tone(force=part * bound, frequency=frequency) for part, frequency in tones)
    scene = ContactScene(friction=FRICTION, slope=slope, boxes=(box,))
    return SceneCase(name=name, scene=scene, time=HOLDING, shake=shake)


def shaken(name: str, slope: float, tones: Tones, shaker: Shaker = Shaker()) -> SceneCase:  # noqa: B008
    """Give a box on a slope [rad], and tones of a force on the mass inside it [N]."""
    scene = ContactScene(friction=FRICTION, slope=slope, boxes=(CASE,), shaker=shaker)
    shake = tuple(Tone(force=force, frequency=frequency) for force, frequency in tones)
    return SceneCase(name=name, scene=scene, time=HOLDING, shake=shake)


class HeldWhileShaken(SceneScenario):
    """A box stays where it is while its load swings below the bound of friction."""

    name = "held-while-shaken"
    metrics = (CREEP,)
    cases = (
        pushed("level, 5 Hz", 0.0, ((0.9, 5),)),
        pushed("level, 3 and 13 Hz", 0.0, ((0.5, 3), (0.4, 13))),
        pushed("slope, 5 Hz", 0.4, ((0.5, 5),)),
        pushed("slope, 3 and 13 Hz", 0.4, ((0.3, 3), (0.2, 13))),
        shaken("level, mass inside, 120 Hz", 0.0, ((4.0, 120),)),
        shaken("slope, mass inside, 14 Hz", 0.1, ((1.0, 14),)),
        shaken("slope, mass inside, 30 Hz", 0.1, ((3.0, 30),)),
        shaken("slope, mass inside, 60 Hz", 0.1, ((3.0, 60),)),
        shaken("slope, mass inside, 8 and 37 Hz", 0.1, ((1.0, 8), (2.0, 37))),
    )
    held_out = (
        pushed("slope, 11 Hz, 5 kg", 0.5, ((0.45, 11),), Box(mass=5.0, side=0.3)),
        pushed("level, 2 and 7 Hz, 0.3 kg", 0.0, ((0.6, 2), (0.3, 7)), Box(mass=0.3, side=0.1)),
        shaken("slope, 0.2 kg inside, 23 Hz", 0.15, ((2.0, 23),), Shaker(mass=0.2, stiffness=500.0, damping=2.0)),
        shaken("level, 0.05 kg inside, 9 and 70 Hz", 0.0, ((1.0, 9), (3.0, 70)), Shaker(mass=0.05)),
    )

    def numbers(self, case: SceneCase, task: SceneTask, series: NamedNumbers) -> Mapping[Metric, Measured]:
        """Read the drift of the box over whole periods: what is elastic is at its end as at its begin."""
        return {CREEP: creep(task, *(np.array(series[name]) for name in ("along", "across")))}

    def steps(self, variant: Variant) -> dict[str, float]:
        """Give three time steps; see `SceneScenario.steps`."""
        own = engine(variant.engine).scene_step
        others = [step for step in STEPS if step != own]
        begin = {} if math.isnan(own) or own == COMMON_STEP else {OWN_STEP: own}
        common = [COMMON_STEP, *others] if own == COMMON_STEP else others
        return begin | {f"{1e3 * step:g} ms": step for step in common[: 3 - len(begin)]}
