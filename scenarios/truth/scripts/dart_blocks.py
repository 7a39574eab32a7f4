"""Blocks in plain DART."""

import dartpy as dart
import numpy as np
from blocks import run


def world_of(block, gravity):
    world = dart.simulation.World()
    world.setTimeStep(block.step)
    world.setGravity([0, 0, -gravity])
    return world


def with_mass(body, block):
    inertia = dart.dynamics.Inertia()
    inertia.setMass(block.mass)
    inertia.setMoment(np.eye(3) * block.mass * 0.04 / 6)
    body.setInertia(inertia)


def joint(block, options):
    world = world_of(block, 0)
    properties = dart.dynamics.PrismaticJointProperties()
    properties.mAxis = [1, 0, 0]
    skeleton = dart.dynamics.Skeleton("block")
    rail, body = skeleton.createPrismaticJointAndBodyNodePair(None, properties)
    with_mass(body, block)
    world.addSkeleton(skeleton)
    skeleton.setVelocities([block.velocity])
    for step in range(block.steps):
        rail.setCoulombFriction(0, block.friction * block.normal(step))
        skeleton.setForces([block.pull(step)])
        world.step()
        yield skeleton.getPositions()[0], skeleton.getVelocities()[0]


def rubbing(body, sides, block):
    node = body.createShapeNode(dart.dynamics.BoxShape(sides))
    node.createCollisionAspect()
    node.createDynamicsAspect()
    node.getDynamicsAspect().setFrictionCoeff(block.friction)


def contact(block, options):
    world, ground, box = world_of(block, block.gravity), dart.dynamics.Skeleton("ground"), dart.dynamics.Skeleton("box")
    weld, base = ground.createWeldJointAndBodyNodePair()
    rubbing(base, [20, 20, 0.2], block)
    below = dart.math.Isometry3()
    below.set_translation([0, 0, -0.1])
    weld.setTransformFromParentBodyNode(below)
    _, body = box.createFreeJointAndBodyNodePair()
    with_mass(body, block)
    rubbing(body, [0.2, 0.2, 0.2], block)
    world.addSkeleton(ground)
    box.setPositions([0, 0, 0, 0, 0, 0.1])
    world.addSkeleton(box)
    begin = 0.0
    for step in range(-block.settling, block.steps):
        if step == 0:
            begin = box.getPositions()[3]
            velocities = box.getVelocities()
            velocities[3] = block.velocity
            box.setVelocities(velocities)
        along, up = block.forces(step)
        if along or up:
            body.addExtForce([along, 0, up], [0, 0, 0], False, True)
        world.step()
        if step >= 0:
            yield box.getPositions()[3] - begin, box.getVelocities()[3]


run({"joint": joint, "contact": contact})
