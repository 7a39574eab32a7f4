"""Scenes as users of Box2D write them, in the plane: polygons, and motors of bounded force in joints."""

from collections.abc import Sequence
from typing import Any

from multibody_xval.engines.interface.scene import (
    BELT,
    FINGER,
    FINGER_MASS,
    GRAVITY,
    GROUND,
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
"""Of Box2D's manual [s]; it has no default."""

UNIT_INERTIA = 6**0.5 / 2
"""Half the side of a square of 1 kg with an inertia of 1 kg m² [m]."""

LINK_HALF = (LINK_LENGTH / 2, 0.005)
"""Half sides of a link [m]."""


def _new_world(setting: SceneSetting, gravity: float) -> Any:
    import Box2D

    return Box2D.b2World(gravity=(0, -gravity), doSleep=setting.sleeping)


def _box(half: Sequence[float], friction: float, mass: float = 0.0) -> Any:
    """Give a box; one without mass is of a body that is not moved by forces."""
    import Box2D

    shape = Box2D.b2PolygonShape(box=(half[0], half[-1]))
    density = mass / (4 * half[0] * half[-1])
    return Box2D.b2FixtureDef(shape=shape, density=density, friction=friction, restitution=0.0)


def _untouched(half: Sequence[float], mass: float) -> Any:
    """Give a box that passes through others."""
    import Box2D

    box = _box(half, 0.0, mass)
    box.filter = Box2D.b2Filter(maskBits=0)
    return box


def _advance(world: Any, setting: SceneSetting) -> None:
    world.Step(setting.time_step, setting.preset["velocityIterations"], setting.preset["positionIterations"])
    world.ClearForces()


def contacts(scene: ContactScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with contacts."""
    check_planar(scene)
    world, rub = _new_world(setting, GRAVITY), scene.friction
    if scene.grip:
        reach, height = scene.finger
        world.CreateStaticBody(position=(-reach, height), fixtures=_box(FINGER, rub))
        finger = _box(FINGER, rub, FINGER_MASS)
        pressed = world.CreateDynamicBody(position=(reach, height), fixtures=finger, allowSleep=setting.sleeping)
        world.CreatePrismaticJoint(bodyA=world.CreateStaticBody(), bodyB=pressed, anchor=pressed.position, axis=(1, 0))
    elif scene.belt:
        world.CreateKinematicBody(position=(0, -0.1), linearVelocity=(scene.belt, 0), fixtures=_box(BELT, rub))
    else:
        x, _, z = scene.normal
        world.CreateStaticBody(position=(-x, -z), angle=-scene.slope, fixtures=_box((GROUND, 1.0), rub))
    for mass, half, place in scene.stack:
        body = world.CreateDynamicBody(
            position=(place[0], place[2]), angle=-scene.slope, fixtures=_box(half, rub, mass),
            allowSleep=setting.sleeping,
        )  # fmt: skip

    def step() -> None:
        if scene.grip:
            pressed.ApplyForceToCenter((-scene.grip, 0), True)
        _advance(world, setting)

    def state() -> Any:
        place, speed = body.position, body.linearVelocity
        return (place[0], 0.0, place[1]), turned(body.angle), (speed[0], 0.0, speed[1])

    def launch(velocity: Vector, spin: float) -> None:
        body.linearVelocity, body.awake = in_plane(velocity, spin), True

    def push(force: float) -> None:
        body.ApplyForceToCenter(along(scene, force)[::2], True)

    return SteppedWorld(step, state, launch, push=push)


def joints(scene: JointScene | ArmScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with joints."""
    return _one_joint(scene, setting) if isinstance(scene, JointScene) else _arm(scene, setting)


def _one_joint(scene: JointScene, setting: SceneSetting) -> SteppedWorld:
    world, hinge = _new_world(setting, 0.0), scene.kind == "hinge"
    still, box = world.CreateStaticBody(), _untouched((UNIT_INERTIA, UNIT_INERTIA), 1.0)
    body = world.CreateDynamicBody(position=(0, 0), fixtures=box, allowSleep=setting.sleeping)
    body.angularDamping = body.linearDamping = scene.damping  # a rate, and so is that of a joint over its inertia of 1
    if hinge:
        body.angularVelocity = scene.velocity
        world.CreateRevoluteJoint(
            bodyA=still, bodyB=body, anchor=(0, 0), enableMotor=True, motorSpeed=0.0, maxMotorTorque=scene.friction
        )
    else:
        body.linearVelocity = (scene.velocity, 0)
        world.CreatePrismaticJoint(
            bodyA=still, bodyB=body, anchor=(0, 0), axis=(1, 0), enableMotor=True, motorSpeed=0.0,
            maxMotorForce=scene.friction,
        )  # fmt: skip

    def step() -> None:
        if hinge:
            body.ApplyTorque(scene.load, True)
        else:
            body.ApplyForceToCenter((scene.load, 0), True)
        _advance(world, setting)

    def state() -> Any:
        return ([body.angle if hinge else body.position[0]],)

    return SteppedWorld(step, state)


def _arm(scene: ArmScene, setting: SceneSetting) -> SteppedWorld:
    world, links = _new_world(setting, GRAVITY), []
    before = world.CreateStaticBody()
    for link, bound in enumerate(scene.friction):
        place, rod = (LINK_LENGTH * (link + 0.5), 0), _untouched(LINK_HALF, LINK_MASS)
        body = world.CreateDynamicBody(position=place, fixtures=rod, allowSleep=setting.sleeping)
        world.CreateRevoluteJoint(
            bodyA=before, bodyB=body, anchor=(LINK_LENGTH * link, 0), enableMotor=True, motorSpeed=0.0,
            maxMotorTorque=bound,
        )  # fmt: skip
        links.append(body)
        before = body

    def step() -> None:
        _advance(world, setting)

    def state() -> Any:
        return (hinge_angles(link.angle for link in links),)

    return SteppedWorld(step, state)
