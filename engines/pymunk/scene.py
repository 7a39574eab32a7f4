"""Scenes as users of pymunk write them, in the plane: polygons, and motors or pivots of bounded force in joints."""

import math
from collections.abc import Sequence
from typing import Any

from multibody_xval.engines.interface.scene import (
    BELT,
    FINGER,
    FINGER_MASS,
    GRAVITY,
    GROUND,
    LINK_INERTIA,
    LINK_LENGTH,
    LINK_MASS,
    ArmScene,
    ContactScene,
    JointScene,
    SceneSetting,
    SteppedWorld,
    Vector,
    along,
)
from multibody_xval.engines.shared.planar_scene import check_planar, hinge_angles, in_plane, turned

STEP = 1 / 60
"""Of pymunk's own examples [s]; it has no default."""

GROOVE = 1e3
"""Half of the length of a groove [m]."""

SLEEP_TIME = 0.5
"""After which resting bodies sleep where they may [s]."""


def _new_space(setting: SceneSetting, gravity: float) -> Any:
    import pymunk

    space = pymunk.Space()
    space.gravity = (0, -gravity)
    for name, value in setting.changes("iterations", "collision_slop").items():
        setattr(space, name, value)
    if setting.sleeping:
        space.sleep_time_threshold = SLEEP_TIME
    return space


def _taken_apart(space: Any) -> None:
    """Take joints out of a space before it is freed.

    A joint refers to its bodies and they to it: pymunk would free them in any order, and now and then end the process.
    """
    space.remove(*space.constraints)


def contacts(scene: ContactScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with contacts."""
    import pymunk

    check_planar(scene)
    space = _new_space(setting, GRAVITY)

    def add(body: Any, half: Sequence[float], place: tuple[float, float], angle: float = 0.0) -> Any:
        body.position, body.angle = place, angle
        shape = pymunk.Poly.create_box(body, (2 * half[0], 2 * half[-1]))
        shape.friction = math.sqrt(scene.friction)  # coefficients of two shapes are multiplied
        space.add(body, shape)
        return body

    if scene.grip:
        reach, height = scene.finger
        add(pymunk.Body(body_type=pymunk.Body.STATIC), FINGER, (-reach, height))
        pressed = add(pymunk.Body(FINGER_MASS, math.inf), FINGER, (reach, height))
        space.add(pymunk.GrooveJoint(space.static_body, pressed, (-1, height), (1, height), (0, 0)))
    elif scene.belt:
        belt = add(pymunk.Body(body_type=pymunk.Body.KINEMATIC), BELT, (0, -BELT[2]))
        belt.velocity = (scene.belt, 0)
    else:
        x, _, z = scene.normal
        add(pymunk.Body(body_type=pymunk.Body.STATIC), (GROUND, 1.0), (-x, -z), -scene.slope)
    for mass, half, place in scene.stack:
        moment = pymunk.moment_for_box(mass, (2 * half[0], 2 * half[2]))
        body = add(pymunk.Body(mass, moment), half, (place[0], place[2]), -scene.slope)

    def step() -> None:
        if scene.grip:
            pressed.apply_force_at_world_point((-scene.grip, 0), pressed.position)
        space.step(setting.time_step)

    def launch(velocity: Vector, spin: float) -> None:
        body.velocity = in_plane(velocity, spin)

    def push(force: float) -> None:
        body.apply_force_at_world_point(along(scene, force)[::2], body.position)

    def state() -> Any:
        place, speed = body.position, body.velocity
        return (place[0], 0.0, place[1]), turned(body.angle), (speed[0], 0.0, speed[1])

    return SteppedWorld(step, state, launch, lambda: _taken_apart(space), push)


def joints(scene: JointScene | ArmScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with joints."""
    return _one_joint(scene, setting) if isinstance(scene, JointScene) else _arm(scene, setting)


def _one_joint(scene: JointScene, setting: SceneSetting) -> SteppedWorld:
    import pymunk

    space, body, hinge = _new_space(setting, 0.0), pymunk.Body(1.0, 1.0), scene.kind == "hinge"
    pin: Any
    rubbing: Any
    space.damping = math.exp(-scene.damping)  # what is left of velocities after a second, of an inertia of 1
    if hinge:
        body.angular_velocity = scene.velocity
        pin = pymunk.PivotJoint(space.static_body, body, (0, 0))
        rubbing = pymunk.SimpleMotor(space.static_body, body, 0)
    else:
        body.velocity = (scene.velocity, 0)
        pin = pymunk.GrooveJoint(space.static_body, body, (-GROOVE, 0), (GROOVE, 0), (0, 0))
        rubbing = pymunk.PivotJoint(space.static_body, body, (0, 0), (0, 0))
        rubbing.max_bias = 0.0  # or it pulls its anchors together
    rubbing.max_force = scene.friction
    space.add(body, pin, rubbing)

    def step() -> None:
        if hinge:
            body.torque = scene.load
        else:
            body.apply_force_at_world_point((scene.load, 0), body.position)
        space.step(setting.time_step)

    def state() -> Any:
        return ([body.angle if hinge else body.position[0]],)

    return SteppedWorld(step, state, close=lambda: _taken_apart(space))


def _arm(scene: ArmScene, setting: SceneSetting) -> SteppedWorld:
    import pymunk

    space = _new_space(setting, GRAVITY)
    before, links = space.static_body, []
    for link, bound in enumerate(scene.friction):
        body = pymunk.Body(LINK_MASS, LINK_INERTIA[1])
        body.position = (LINK_LENGTH * (link + 0.5), 0)
        motor = pymunk.SimpleMotor(before, body, 0)
        motor.max_force = bound
        space.add(body, pymunk.PivotJoint(before, body, (LINK_LENGTH * link, 0)), motor)
        links.append(body)
        before = body

    def step() -> None:
        space.step(setting.time_step)

    def state() -> Any:
        return (hinge_angles(link.angle for link in links),)

    return SteppedWorld(step, state, close=lambda: _taken_apart(space))
