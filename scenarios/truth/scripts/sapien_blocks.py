"""Blocks in plain SAPIEN: dry friction of a joint is a drive of bounded force; its own friction is no force."""

import numpy as np
import sapien
from blocks import run

DAMPING = 1e20


def world(block, gravity):
    sapien.physx.set_scene_config(gravity=np.array([0, 0, -gravity], np.float32))
    system = sapien.physx.PhysxCpuSystem()
    system.timestep = block.step
    return sapien.Scene([system]), system


def joint(block, options):
    scene, system = world(block, 0)
    builder, here = scene.create_articulation_builder(), sapien.Pose()
    root = builder.create_link_builder()
    root.set_mass_and_inertia(1.0, here, np.ones(3))
    link = builder.create_link_builder(root)
    link.set_mass_and_inertia(block.mass, here, np.ones(3))
    link.set_joint_properties("prismatic", [[-np.inf, np.inf]], here, here, 0.0, 0.0)
    robot = builder.build(fix_root_link=True)
    for each in robot.get_links():
        each.set_linear_damping(0.0)
    rail = robot.get_active_joints()[0]
    rail.set_friction(0.0)
    robot.set_qvel(np.array([block.velocity], np.float32))
    for step in range(block.steps):
        rail.set_drive_properties(0.0, DAMPING, block.friction * block.normal(step), "force")
        robot.set_qf(np.array([block.pull(step)], np.float32))
        system.step()
        yield robot.qpos[0], robot.qvel[0]


def contact(block, options):
    scene, system = world(block, block.gravity)
    material = sapien.physx.PhysxMaterial(block.friction, block.friction, 0.0)
    bodies = sapien.physx.PhysxRigidStaticComponent(), sapien.physx.PhysxRigidDynamicComponent()
    for body, half, height in zip(bodies, ([9, 9, 1], [0.1, 0.1, 0.1]), (-1, 0.1)):
        body.attach(sapien.physx.PhysxCollisionShapeBox(half, material))
        entity = sapien.Entity()
        entity.add_component(body)
        entity.set_pose(sapien.Pose([0, 0, height]))
        scene.add_entity(entity)
    box, begin = bodies[1], 0.0
    box.set_mass(block.mass)
    box.set_inertia(np.full(3, block.mass * 0.04 / 6))
    for step in range(-block.settling, block.steps):
        if step == 0:
            begin = box.entity.pose.p[0]
            box.set_linear_velocity([block.velocity, 0, 0])
        along, up = block.forces(step)
        box.add_force_torque(np.array([along, 0, up], np.float32), np.zeros(3, np.float32))
        system.step()
        if step >= 0:
            yield box.entity.pose.p[0] - begin, box.linear_velocity[0]


run({"joint": joint, "contact": contact})
