"""Scenes as users of DART write them: skeletons of one body, and the Coulomb friction of joints."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from multibody_xval.engines.dart.joint import new_world
from multibody_xval.engines.interface.scene import (
    BELT,
    FINGER,
    FINGER_MASS,
    GRAVITY,
    GROUND,
    LEVEL,
    LINK_INERTIA,
    LINK_LENGTH,
    LINK_MASS,
    ArmScene,
    ContactScene,
    JointScene,
    Quaternion,
    SceneSetting,
    SteppedWorld,
    Vector,
    along,
)

STEP = 0.001
"""DART's own time step [s]."""

BELT_MASS = 1e5
"""Of a belt that slides, whatever acts on it [kg]."""


def _rotation(turned: Quaternion) -> Any:
    w, x, y, z = turned
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip


def _pose(place: Vector, turned: Quaternion = LEVEL) -> Any:
    import dartpy

    pose = dartpy.math.Isometry3()
    pose.set_rotation(_rotation(turned))
    pose.set_translation(np.array(place))
    return pose


def _add_box(body: Any, half: Sequence[float], mass: float, friction: float) -> None:
    """Give a body a box; one without mass keeps DART's own, which is fixed."""
    import dartpy

    shape = body.createShapeNode(dartpy.dynamics.BoxShape([2 * side for side in half]))
    shape.createCollisionAspect()
    surface = shape.createDynamicsAspect()
    surface.setFrictionCoeff(friction)
    surface.setRestitutionCoeff(0.0)
    if mass:
        body.setMass(mass)
        squares = np.square(half)
        inertia = mass / 3 * (np.sum(squares) - squares)
        body.setMomentOfInertia(*inertia.tolist(), 0.0, 0.0, 0.0)


def contacts(scene: ContactScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with contacts."""
    import dartpy

    world, rub = new_world(setting.time_step, setting.sleeping, GRAVITY), scene.friction
    new_skeleton = dartpy.dynamics.Skeleton

    def fixed(half: Sequence[float], place: Vector, turned: Quaternion = LEVEL) -> None:
        skeleton = new_skeleton()
        joint, body = skeleton.createWeldJointAndBodyNodePair()
        joint.setTransformFromParentBodyNode(_pose(place, turned))
        _add_box(body, half, 0.0, rub)
        skeleton.setMobile(False)
        world.addSkeleton(skeleton)

    def sliding(half: Sequence[float], place: Vector, mass: float) -> Any:
        skeleton = new_skeleton()
        joint, body = skeleton.createPrismaticJointAndBodyNodePair()
        joint.setAxis([1.0, 0.0, 0.0])
        joint.setTransformFromParentBodyNode(_pose(place))
        _add_box(body, half, mass, rub)
        world.addSkeleton(skeleton)
        return skeleton

    if scene.grip:
        reach, height = scene.finger
        fixed(FINGER, (-reach, 0.0, height))
        pressed = sliding(FINGER, (reach, 0.0, height), FINGER_MASS)
    elif scene.belt:
        sliding(BELT, (0.0, 0.0, -BELT[2]), BELT_MASS).setVelocities([scene.belt])
    else:
        x, y, z = scene.normal
        fixed((GROUND, GROUND, 1.0), (-x, -y, -z), scene.tilt)
    for mass, half, place in scene.stack:
        skeleton = new_skeleton()
        joint, body = skeleton.createFreeJointAndBodyNodePair()
        _add_box(body, half, mass, rub)
        joint.setPositions(dartpy.dynamics.FreeJoint.convertToPositions(_pose(place, scene.orientation)))
        world.addSkeleton(skeleton)

    def step() -> None:
        if scene.grip:
            pressed.setForces([-scene.grip])
        world.step()

    def state() -> Any:
        pose = body.getWorldTransform()
        return pose.translation(), _quaternion(np.array(pose.rotation())), body.getCOMLinearVelocity()

    def launch(velocity: Vector, spin: float) -> None:
        rotation = np.array(body.getWorldTransform().rotation())
        skeleton.setVelocities(np.concatenate([rotation.T @ (0, 0, spin), rotation.T @ velocity]))

    def push(force: float) -> None:
        body.setExtForce(along(scene, force))

    return SteppedWorld(step, state, launch, push=push)


def _quaternion(rotation: Any) -> Any:
    """Give the quaternion of a rotation by less than half a turn."""
    scalar = np.sqrt(max(0.0, 1 + np.trace(rotation))) / 2
    skew = rotation - rotation.T
    return scalar, *(np.array([skew[2, 1], skew[0, 2], skew[1, 0]]) / (4 * scalar))


def joints(scene: JointScene | ArmScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with joints."""
    import dartpy

    single = isinstance(scene, JointScene)
    world = new_world(setting.time_step, setting.sleeping, 0.0 if single else GRAVITY)
    skeleton = dartpy.dynamics.Skeleton()
    if isinstance(scene, JointScene):
        slides = scene.kind == "slide"
        kind = skeleton.createPrismaticJointAndBodyNodePair if slides else skeleton.createRevoluteJointAndBodyNodePair
        joint, body = kind()
        joint.setAxis([1.0, 0, 0] if slides else [0, 0, 1.0])
        joint.setCoulombFriction(0, scene.friction)
        joint.setDampingCoefficient(0, scene.damping)
        joint.setVelocity(0, scene.velocity)
        body.setMass(1.0)
        body.setMomentOfInertia(1, 1, 1, 0, 0, 0)
    else:
        body = None
        for index, bound in enumerate(scene.friction):
            joint, body = skeleton.createRevoluteJointAndBodyNodePair(*([] if body is None else [body]))
            joint.setAxis([0.0, 1, 0])
            joint.setTransformFromParentBodyNode(_pose((LINK_LENGTH if index else 0.0, 0.0, 0.0)))
            joint.setCoulombFriction(0, bound)
            body.setMass(LINK_MASS)
            body.setLocalCOM([LINK_LENGTH / 2, 0, 0])
            body.setMomentOfInertia(*LINK_INERTIA, 0, 0, 0)
    world.addSkeleton(skeleton)

    def step() -> None:
        if isinstance(scene, JointScene):
            skeleton.setForces([scene.load])
        world.step()

    def state() -> Any:
        return (skeleton.getPositions(),)

    return SteppedWorld(step, state)
