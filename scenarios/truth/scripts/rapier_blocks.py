"""Blocks in plain Rapier: dry friction of a joint is that of its MJCF loader, in a multibody."""

import rapier3d
from blocks import run
from rapier3d.loaders import mjcf

JOINT = """<mujoco><option gravity="0 0 0"/><worldbody><body><joint type="slide" axis="1 0 0" frictionloss="{bound!r}"/>
<inertial pos="0 0 0" mass="{mass!r}" diaginertia="1 1 1"/></body></worldbody></mujoco>"""


def world_of(block, gravity):
    world = rapier3d.PhysicsWorld()
    world.gravity = rapier3d.Vec3(0.0, 0.0, -gravity)
    world.integration_parameters.dt = block.step
    return world


def joint(block, options):
    world = world_of(block, 0.0)
    robot, _ = mjcf.MjcfRobot.from_str(JOINT.format(mass=block.mass, bound=block.bound))
    loaded = robot.insert_using_multibody_joints(
        world.rigid_bodies, world.colliders, world.multibody_joints, world.impulse_joints
    )
    world.step()  # at rest: the first one does not know the mass
    multibody = world.multibody_joints.multibody(loaded.joints[0].joint)
    body = world.rigid_bodies[loaded.bodies[1].body]
    multibody.set_generalized_velocity([block.velocity])
    for step in range(block.steps):
        body.reset_forces(True)
        body.add_force(rapier3d.Vec3(block.pull(step), 0.0, 0.0), True)
        world.step()
        yield body.translation.x, multibody.generalized_velocity()[0]


def contact(block, options):
    world = world_of(block, block.gravity)
    ground = rapier3d.Collider.cuboid(9.0, 9.0, 1.0).friction(block.friction)
    world.add_body(rapier3d.RigidBody.fixed().translation(rapier3d.Vec3(0.0, 0.0, -1.0)), [ground])
    box = rapier3d.Collider.cuboid(0.1, 0.1, 0.1).friction(block.friction).density(block.mass / 0.008)
    handle = world.add_body(rapier3d.RigidBody.dynamic().translation(rapier3d.Vec3(0.0, 0.0, 0.1)), [box])
    body = world.rigid_bodies[handle]
    begin = 0.0
    for step in range(-block.settling, block.steps):
        if step == 0:
            begin = body.translation.x
            body.linvel = rapier3d.Vec3(block.velocity, 0.0, 0.0)
        along, up = block.forces(step)
        body.reset_forces(bool(along))
        body.add_force(rapier3d.Vec3(along, 0.0, up), bool(along))
        world.step()
        if step >= 0:
            yield body.translation.x - begin, body.linvel.x


run({"joint": joint, "contact": contact})
