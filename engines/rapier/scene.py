"""Scenes as users of Rapier write them: rigid bodies, and motors of bounded force as dry friction of joints."""

from collections.abc import Sequence
from typing import Any

import numpy as np

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
    Quaternion,
    SceneSetting,
    SteppedWorld,
    Vector,
    along,
)
from multibody_xval.engines.rapier.joint import new_world
from reference_lcp.validation import FloatArray

STEP = 1 / 60
"""Rapier's own time step [s]."""

SOLVER = ("num_solver_iterations", "num_internal_pgs_iterations")
"""Options of the whole world."""

MULTIBODY = "multibody"
"""Joints in reduced coordinates, whose pins cannot give way while their motors are solved for."""

LINK_HALF = (LINK_LENGTH / 2, 0.005, 0.005)
"""Half sides of a link [m]."""


def _world(setting: SceneSetting, gravity: float) -> Any:
    import rapier3d

    world = new_world(setting.time_step, setting.changes(*SOLVER))
    world.gravity = rapier3d.Vec3(0, 0, -gravity)
    return world


def _box(half: Sequence[float], mass: float, friction: float) -> Any:
    """Give a collider; one without mass is of a body that is not moved by forces."""
    import rapier3d

    box = rapier3d.Collider.cuboid(*map(float, half)).friction(friction).restitution(0.0)
    return box.density(mass / float(np.prod(2 * np.array(half)))) if mass else box


def _scaled_axis(turned: Quaternion) -> Vector:
    """Give a rotation as Rapier takes it: its axis, as long as its angle [rad]."""
    axis = np.array(turned[1:])
    size = float(np.linalg.norm(axis))
    x, y, z = (axis * 2 * np.arctan2(size, turned[0]) / (size or 1.0)).tolist()
    return x, y, z


def _quaternion(rotation: Any) -> FloatArray:
    """Read a rotation of Rapier."""
    vector = rotation.scaled_axis() if callable(rotation.scaled_axis) else rotation.scaled_axis
    axis = np.array([vector.x, vector.y, vector.z])
    angle = float(np.linalg.norm(axis))
    return np.array([np.cos(angle / 2), *(np.sinc(angle / 2 / np.pi) / 2 * axis)])


def contacts(scene: ContactScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with contacts."""
    import rapier3d

    world, rub = _world(setting, GRAVITY), scene.friction
    vector, bodies = rapier3d.Vec3, rapier3d.RigidBody
    if scene.grip:
        reach, height = scene.finger
        world.add_body(bodies.fixed().translation(vector(-reach, 0, height)), [_box(FINGER, 0, rub)])
        finger = bodies.dynamic().translation(vector(reach, 0, height)).can_sleep(setting.sleeping)
        finger = finger.enabled_translations((True, False, False)).enabled_rotations((False, False, False))
        pressed = world.add_body(finger, [_box(FINGER, FINGER_MASS, rub)])
        world.rigid_bodies[pressed].add_force(vector(-scene.grip, 0, 0), True)
    elif scene.belt:
        belt = bodies.kinematic_velocity_based().translation(vector(0, 0, -0.1)).linvel(vector(scene.belt, 0, 0))
        world.add_body(belt, [_box(BELT, 0, rub)])
    else:
        x, y, z = scene.normal
        ground = bodies.fixed().rotation(_scaled_axis(scene.tilt)).translation(vector(-x, -y, -z))
        world.add_body(ground, [_box((GROUND, GROUND, 1.0), 0, rub)])
    for mass, half, place in scene.stack:
        free = bodies.dynamic().rotation(_scaled_axis(scene.orientation)).translation(vector(*place))
        handle = world.add_body(free.can_sleep(setting.sleeping), [_box(half, mass, rub)])
    body = world.rigid_bodies[handle]

    def state() -> Any:
        place, speed = body.translation, body.linvel
        return (place.x, place.y, place.z), _quaternion(body.rotation), (speed.x, speed.y, speed.z)

    def launch(velocity: Vector, spin: float) -> None:
        body.linvel, body.angvel = vector(*velocity), vector(0, 0, spin)

    def push(force: float) -> None:
        body.reset_forces(True)
        body.add_force(vector(*along(scene, force)), True)

    return SteppedWorld(world.step, state, launch, push=push)


def joints(scene: JointScene | ArmScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with joints: motors of target velocity zero between bodies, as impulse joints."""
    return _one_joint(scene, setting) if isinstance(scene, JointScene) else _arm(scene, setting)


def _rubbing(builder: Any, bound: float, setting: SceneSetting) -> Any:
    """Add dry friction to a joint: a motor that holds its velocity at zero with a bounded force."""
    import rapier3d

    motor = builder.motor_velocity(0.0, setting.preset["motor factor"]).motor_max_force(bound)
    return motor.motor_model(rapier3d.MotorModel.FORCE_BASED)


def _one_joint(scene: JointScene, setting: SceneSetting) -> SteppedWorld:
    import rapier3d

    world, vector, hinge = _world(setting, 0.0), rapier3d.Vec3, scene.kind == "hinge"
    root = world.add_body(rapier3d.RigidBody.fixed())
    half = [6**0.5 / 2] * 3  # a cube of 1 kg with an inertia of 1 kg m²
    free = rapier3d.RigidBody.dynamic().can_sleep(setting.sleeping)
    free = free.angular_damping(scene.damping).linear_damping(scene.damping)  # rates, of an inertia of 1
    handle = world.add_body(free, [_box(half, 1.0, 0.0).sensor(True)])
    kind = rapier3d.RevoluteJoint if hinge else rapier3d.PrismaticJoint
    world.impulse_joints.insert(root, handle, _rubbing(kind.builder(vector(1, 0, 0)), scene.friction, setting))
    body = world.rigid_bodies[handle]
    (body.add_torque if hinge else body.add_force)(vector(scene.load, 0, 0), True)
    if hinge:
        body.angvel = vector(scene.velocity, 0, 0)
    else:
        body.linvel = vector(scene.velocity, 0, 0)

    def state() -> Any:
        turned = _quaternion(body.rotation)
        return ((2 * np.arctan2(turned[1], turned[0]) if hinge else body.translation.x),)

    return SteppedWorld(world.step, state)


def _arm(scene: ArmScene, setting: SceneSetting) -> SteppedWorld:
    import rapier3d

    world, vector = _world(setting, GRAVITY), rapier3d.Vec3
    before, links = world.add_body(rapier3d.RigidBody.fixed()), []
    for link, bound in enumerate(scene.friction):
        free = rapier3d.RigidBody.dynamic().translation(vector(LINK_LENGTH * (link + 0.5), 0, 0))
        handle = world.add_body(free.can_sleep(setting.sleeping), [_box(LINK_HALF, LINK_MASS, 0.0).sensor(True)])
        joint = rapier3d.RevoluteJoint.builder(vector(0, 1, 0)).local_anchor1(
            vector(LINK_LENGTH / 2 * bool(link), 0, 0)
        )
        joint = joint.local_anchor2(vector(-LINK_LENGTH / 2, 0, 0))
        inserted = world.multibody_joints if setting.changed("joints") == MULTIBODY else world.impulse_joints
        inserted.insert(before, handle, _rubbing(joint, bound, setting))
        links.append(world.rigid_bodies[handle])
        before = handle

    def state() -> Any:
        angles = [2 * np.arctan2(turned[2], turned[0]) for turned in (_quaternion(link.rotation) for link in links)]
        return (np.diff(np.unwrap(angles), prepend=0.0),)

    return SteppedWorld(world.step, state)
