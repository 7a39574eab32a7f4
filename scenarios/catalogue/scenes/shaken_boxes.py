"""Boxes that friction holds while they are shaken: by a force that swings, or by a mass inside that a force shakes."""

import math
from itertools import islice

from multibody_xval.engines.interface.scene import GRAVITY, Box, ContactScene, Shaker
from multibody_xval.scenarios.cases.scene_motion import SceneMotion, Tone
from multibody_xval.scenarios.catalogue.scenario import COMMON_STEP, Scenario, scene_steps
from multibody_xval.scenarios.catalogue.scenes.held_boxes import DRIFT
from multibody_xval.scenarios.catalogue.scenes.scene import SOURCE, watched

STEPS = (COMMON_STEP, 0.0005, 0.002)
"""The first two that are not the engine's own come beside it [s]: whole periods have whole steps of each."""

FRICTION = 0.5

CASE = Box(side=0.1)
"""With a shaker inside [kg], [m]."""

Tones = tuple[tuple[float, int], ...]
"""Amplitudes and frequencies [Hz], whole ones: the box is then watched for whole periods, and what is elastic is at
their end as at their begin."""


def pushed(load: float, tones: Tones, box: Box = Box()) -> SceneMotion:  # noqa: B008
    """Give a box on a slope with this load, and tones of a force on it; all are parts of the bound of friction."""
    slope = math.atan(load * FRICTION)
    bound = FRICTION * box.mass * GRAVITY * math.cos(slope)
    shake = tuple(Tone(force=part * bound, frequency=frequency) for part, frequency in tones)
    return watched(ContactScene(friction=FRICTION, slope=slope, boxes=(box,)), shake=shake)


def shaken(slope: float, tones: Tones, shaker: Shaker = Shaker()) -> SceneMotion:  # noqa: B008
    """Give a box on a slope [rad], and tones of a force on the mass inside it [N]."""
    scene = ContactScene(friction=FRICTION, slope=slope, boxes=(CASE,), shaker=shaker)
    return watched(scene, shake=tuple(Tone(force=force, frequency=frequency) for force, frequency in tones))


HELD_WHILE_SHAKEN = Scenario(
    name="held-while-shaken",
    question="Does a box stay where it is while its load swings below the bound?",
    expects="no motion",
    source=SOURCE,
    cases={
        "level, 5 Hz": pushed(0.0, ((0.9, 5),)),
        "level, 3 and 13 Hz": pushed(0.0, ((0.5, 3), (0.4, 13))),
        "slope, 5 Hz": pushed(0.4, ((0.5, 5),)),
        "slope, 3 and 13 Hz": pushed(0.4, ((0.3, 3), (0.2, 13))),
        "level, mass inside, 120 Hz": shaken(0.0, ((4.0, 120),)),
        "slope, mass inside, 14 Hz": shaken(0.1, ((1.0, 14),)),
        "slope, mass inside, 30 Hz": shaken(0.1, ((3.0, 30),)),
        "slope, mass inside, 60 Hz": shaken(0.1, ((3.0, 60),)),
        "slope, mass inside, 8 and 37 Hz": shaken(0.1, ((1.0, 8), (2.0, 37))),
    },
    held_out={
        "slope, 11 Hz, 5 kg": pushed(0.5, ((0.45, 11),), Box(mass=5.0, side=0.3)),
        "level, 2 and 7 Hz, 0.3 kg": pushed(0.0, ((0.6, 2), (0.3, 7)), Box(mass=0.3, side=0.1)),
        "slope, 0.2 kg inside, 23 Hz": shaken(0.15, ((2.0, 23),), Shaker(mass=0.2, stiffness=500.0, damping=2.0)),
        "level, 0.05 kg inside, 9 and 70 Hz": shaken(0.0, ((1.0, 9), (3.0, 70)), Shaker(mass=0.05)),
    },
    quantities=(DRIFT,),
    steps=lambda config, case: dict(islice(scene_steps(config, case, STEPS).items(), 3)),
)

SCENARIOS = (HELD_WHILE_SHAKEN,)
