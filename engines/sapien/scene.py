"""Scenes as users of SAPIEN write them: rigid bodies, and articulations whose drives are the dry friction of joints."""

from typing import Any

import numpy as np

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
from multibody_xval.engines.sapien.joint import import_sapien, new_scene

STEP = 0.01
"""SAPIEN's own time step [s]."""

ALONG_X = [False, True, True, True, True, True]
"""Locked motions of a finger on a prismatic joint."""

ABOUT_Y = (2**-0.5, 0.0, 0.0, 2**-0.5)
"""Turns the axis of a joint, which is x, into y."""


def contacts(scene: ContactScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with contacts."""
    sapien, (world, system) = import_sapien(), new_scene(setting.preset, setting.time_step, GRAVITY, setting.sleeping)
    physx = sapien.physx
    material = physx.PhysxMaterial(scene.friction, scene.friction, 0.0)

    def add(body: Any, half: Any, place: Vector, turned: Quaternion = LEVEL, mass: float = 0.0) -> Any:
        shape = physx.PhysxCollisionShapeBox(half, material)
        if mass:
            shape.set_density(mass / float(np.prod(2 * np.array(half))))
        body.attach(shape)
        entity = sapien.Entity()
        entity.add_component(body)
        entity.set_pose(sapien.Pose(place, turned))
        world.add_entity(entity)
        return body

    if scene.grip:
        reach, height = scene.finger
        add(physx.PhysxRigidStaticComponent(), FINGER, (-reach, 0.0, height))
        pressed = add(physx.PhysxRigidDynamicComponent(), FINGER, (reach, 0.0, height), mass=FINGER_MASS)
        pressed.set_locked_motion_axes(ALONG_X)
    elif scene.belt:
        belt = physx.PhysxRigidDynamicComponent()
        belt.set_kinematic(True)
        add(belt, BELT, (0.0, 0.0, -BELT[2]))
    else:
        x, y, z = scene.normal
        add(physx.PhysxRigidStaticComponent(), (GROUND, GROUND, 1.0), (-x, -y, -z), scene.tilt)
    for mass, half, place in scene.stack:
        body = add(physx.PhysxRigidDynamicComponent(), half, place, scene.orientation, mass)
    time = 0.0

    def step() -> None:
        nonlocal time
        time += setting.time_step
        if scene.grip:
            pressed.add_force_torque(np.array([-scene.grip, 0.0, 0.0]), np.zeros(3))
        if scene.belt:
            belt.set_kinematic_target(sapien.Pose([scene.belt * time, 0.0, -0.1]))
        system.step()

    def state() -> Any:
        assert world is not None, "bodies do not keep their scene"
        pose = body.entity_pose
        return pose.p, pose.q, body.linear_velocity

    def launch(velocity: Vector, spin: float) -> None:
        body.set_linear_velocity(velocity)
        body.set_angular_velocity((0, 0, spin))

    def push(force: float) -> None:
        body.add_force_torque(np.array(along(scene, force)), np.zeros(3))

    return SteppedWorld(step, state, launch, push=push)


def joints(scene: JointScene | ArmScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with joints."""
    single = isinstance(scene, JointScene)
    sapien, gravity = import_sapien(), 0.0 if single else GRAVITY
    world, system = new_scene(setting.preset, setting.time_step, gravity, setting.sleeping)
    pose, builder = sapien.Pose, world.create_articulation_builder()
    link = builder.create_link_builder()
    link.set_mass_and_inertia(1.0, pose(), np.ones(3))
    bounds = [scene.friction] if isinstance(scene, JointScene) else scene.friction
    kind = "prismatic" if isinstance(scene, JointScene) and scene.kind == "slide" else "revolute"
    axis = LEVEL if single else ABOUT_Y
    for index in range(len(bounds)):
        link = builder.create_link_builder(link)
        link.set_joint_name(str(index))
        centre = pose() if single else pose([LINK_LENGTH / 2, 0, 0])
        link.set_mass_and_inertia(LINK_MASS, centre, np.ones(3) if single else np.array(LINK_INERTIA))
        parent = pose([0 if single or not index else LINK_LENGTH, 0, 0], axis)
        link.set_joint_properties(kind, [[-np.inf, np.inf]], parent, pose([0, 0, 0], axis), 0.0, 0.0)
    articulation = builder.build(fix_root_link=True)
    for each in articulation.get_links():
        each.set_linear_damping(scene.damping or setting.preset["linear damping"])  # rates, of an inertia of 1
        if scene.damping or setting.changed("angular damping") is not None:
            each.set_angular_damping(scene.damping)
    for joint in articulation.get_active_joints():
        joint.set_friction(setting.preset["joint friction"])
        joint.set_drive_properties(0.0, setting.preset["drive damping"], bounds[int(joint.name)], "force")
    load = np.array([scene.load if isinstance(scene, JointScene) else 0.0] * len(bounds), np.float32)

    def step() -> None:
        articulation.set_qf(load)
        system.step()

    articulation.set_qvel(np.full(len(bounds), scene.velocity, np.float32))

    def state() -> Any:
        assert world is not None, "articulations do not keep their scene"
        return (articulation.qpos,)

    return SteppedWorld(step, state)
