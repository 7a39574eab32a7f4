"""Blocks in plain PyBullet: dry friction of a joint is its velocity motor, of bounded force."""

import pybullet
from blocks import run


def world(block, gravity):
    pybullet.connect(pybullet.DIRECT)
    pybullet.resetSimulation()
    pybullet.setTimeStep(block.step)
    pybullet.setGravity(0, 0, -gravity)


def joint(block, options):
    world(block, 0)
    body = pybullet.createMultiBody(
        baseMass=0,
        linkMasses=[block.mass],
        linkCollisionShapeIndices=[-1],
        linkVisualShapeIndices=[-1],
        linkPositions=[[0, 0, 0]],
        linkOrientations=[[0, 0, 0, 1]],
        linkInertialFramePositions=[[0, 0, 0]],
        linkInertialFrameOrientations=[[0, 0, 0, 1]],
        linkParentIndices=[0],
        linkJointTypes=[pybullet.JOINT_PRISMATIC],
        linkJointAxis=[[1, 0, 0]],
    )
    pybullet.changeDynamics(body, 0, linearDamping=0, angularDamping=0, jointDamping=0)
    pybullet.resetJointState(body, 0, 0, block.velocity)
    for step in range(block.steps):
        bound = block.friction * block.normal(step)
        pybullet.setJointMotorControl2(body, 0, pybullet.VELOCITY_CONTROL, targetVelocity=0, force=bound)
        pybullet.applyExternalForce(body, 0, [block.pull(step), 0, 0], [0, 0, 0], pybullet.LINK_FRAME)
        pybullet.stepSimulation()
        yield pybullet.getJointState(body, 0)[:2]


def contact(block, options):
    world(block, block.gravity)
    ground = pybullet.createMultiBody(0, pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[9, 9, 1]))
    pybullet.resetBasePositionAndOrientation(ground, [0, 0, -1], [0, 0, 0, 1])
    shape = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[0.1, 0.1, 0.1])
    box = pybullet.createMultiBody(block.mass, shape, basePosition=[0, 0, 0.1])
    pybullet.changeDynamics(ground, -1, lateralFriction=1)
    pybullet.changeDynamics(box, -1, lateralFriction=block.friction, linearDamping=0, angularDamping=0)
    begin = 0.0
    for step in range(-block.settling, block.steps):
        if step == 0:
            begin = pybullet.getBasePositionAndOrientation(box)[0][0]
            pybullet.resetBaseVelocity(box, [block.velocity, 0, 0])
        along, up = block.forces(step)
        place = pybullet.getBasePositionAndOrientation(box)[0]
        pybullet.applyExternalForce(box, -1, [along, 0, up], place, pybullet.WORLD_FRAME)
        pybullet.stepSimulation()
        if step >= 0:
            x = pybullet.getBasePositionAndOrientation(box)[0][0]
            yield x - begin, pybullet.getBaseVelocity(box)[0][0]


run({"joint": joint, "contact": contact})
