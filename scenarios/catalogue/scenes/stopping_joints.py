"""Joints that are thrown, and stop by friction and damping."""

import math
from functools import partial

from multibody_xval.engines.interface.scene import JointScene
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.catalogue.scenario import Quantity, Scenario, scene_steps
from multibody_xval.scenarios.catalogue.scenes.loaded_joints import is_slide
from multibody_xval.scenarios.catalogue.scenes.scene import NONE, SOURCE, time_step
from multibody_xval.scenarios.model import AnyCase, Result, Run

FOLLOWED = 3.0
"""How long a joint is followed [s]: three times the longest stop, for some engines stop it late."""

SPEED = 20.0
"""Of a hinge [rad/s]: three turns in a second."""


def thrown(friction: float, damping: float = 0.0, velocity: float = SPEED, kind: str = "hinge") -> SceneMotion:
    """Give a joint of 1 kg m² or 1 kg that is thrown; see `JointScene`."""
    scene = JointScene(kind=kind, friction=friction, damping=damping, velocity=velocity)
    return SceneMotion(scene=scene, time=FOLLOWED)


def thrown_joint(case: AnyCase) -> JointScene:
    """Give the joint of a case."""
    assert isinstance(case, SceneMotion), "a scene"
    assert isinstance(case.scene, JointScene), "a joint"
    return case.scene


def exact_stop(joint: JointScene) -> tuple[float, float]:
    """Give when a joint of inertia I = 1 stops [s], and how far from its start [rad] or [m].

    By Coulomb's law: t = I/c ln(1 + c v/T), or I v/T without damping; friction and damping take the momentum,
    I v = T t + c s, or the energy without damping, I v²/2 = T s.
    """
    ratio = joint.damping * joint.velocity / joint.friction
    time = joint.velocity / joint.friction * (math.log1p(ratio) / ratio if ratio else 1.0)
    if not ratio:
        return time, joint.velocity * time / 2
    return time, (joint.velocity - joint.friction * time) / joint.damping


def euler_s_stop(joint: JointScene, step: float) -> float:
    """Give when it stops in steps of Euler that take damping at their end [s]."""
    steps, velocity = 0, joint.velocity
    while velocity > 0:
        velocity = (velocity - step * joint.friction) / (1 + step * joint.damping)
        steps += 1
    return steps * step


def late(result: Result, run: Run) -> float:
    """Read by how much a joint stops too late [ms]; infinite if it never does."""
    return 1e3 * (min(result.series["stop"], default=math.inf) - exact_stop(thrown_joint(run.case))[0])


def late_in_steps(run: Run) -> float:
    """Give Euler's error, the step in which it stops, and one that positions may be behind velocities [ms]."""
    joint, step = thrown_joint(run.case), time_step(run)
    return 1e3 * (2 * step + abs(euler_s_stop(joint, step) - exact_stop(joint)[0]))


def overrun(result: Result, run: Run) -> float:
    """Read how far beyond its exact way a joint is at the end [mrad], [mm]."""
    return 1e3 * (result.series["joint 1"][-1] - exact_stop(thrown_joint(run.case))[1])


def first_step(run: Run) -> float:
    """Give the way of the first step [mrad], [mm]: it is missed where damping is taken at the start of a step."""
    return 1e3 * time_step(run) * thrown_joint(run.case).velocity


where = partial(Quantity, exact=0.0, read=overrun, step_error=first_step)

JOINT_STOP = Scenario(
    name="joint-stop",
    question="When and where does a joint stop that is thrown, by its friction and its damping?",
    expects="closed form: I/c ln(1 + c v/T); allowed: what a step of semi-implicit Euler moves a body",
    source=SOURCE,
    cases={
        "no damping, 0.8 s": thrown(25.0),
        "damped, 0.22 s": thrown(25.0, 10.0),
        "damped, 7.4 ms": thrown(250.0, 500.0),
        "damped, 0.21 ms": thrown(2500.0, 25000.0),
    },
    held_out={
        "hinge, 15 rad/s, 0.31 s": thrown(20.0, 5.0, 15.0),
        "slide, 3 m/s, 0.13 s": thrown(15.0, 6.0, 3.0, "slide"),
        "slide, 2 m/s, 7.6 ms": thrown(40.0, 400.0, 2.0, "slide"),
    },
    quantities=(
        Quantity(
            name="late", unit="ms", exact=0.0, read=late, step_error=late_in_steps,
            meaning="Time from which on a joint rests that was thrown, less the exact one.",
        ),
        where(
            name="angle", unit="mrad", of=lambda case: not is_slide(case), resolution=NONE["stop"],
            meaning="Angle of a hinge that was thrown, less the exact one at its stop.",
        ),
        where(
            name="way", unit="mm", of=is_slide, resolution=NONE["stop"],
            meaning="Way of a slide that was thrown, less the exact one at its stop.",
        ),
    ),
    steps=scene_steps,
)  # fmt: skip

SCENARIOS = (JOINT_STOP,)
