"""Blocks in plain Drake: friction of a joint is an actuator of bounded force that holds its velocity at zero."""

import numpy as np
from blocks import run
from pydrake.geometry import HalfSpace, Sphere
from pydrake.math import RigidTransform
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, CoulombFriction, MultibodyPlant
from pydrake.multibody.tree import (
    PdControllerGains,
    PrismaticJoint,
    SpatialInertia,
    UnitInertia,
    default_model_instance,
)
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

DAMPING = 1e3


def with_block(plant, block, gravity):
    plant.mutable_gravity_field().set_gravity_vector([0, 0, -gravity])
    size = 0.04 / 6
    return plant.AddRigidBody("block", SpatialInertia(block.mass, [0, 0, 0], UnitInertia(size, size, size)))


def started(builder, plant):
    simulator = Simulator(builder.Build())
    return simulator, plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())


def joint(block, options):
    builder = DiagramBuilder()
    plant = builder.AddSystem(MultibodyPlant(block.step))
    body = with_block(plant, block, 0)
    rail = plant.AddJoint(PrismaticJoint("rail", plant.world_frame(), body.body_frame(), [1, 0, 0]))
    actuator = plant.AddJointActuator("friction", rail, block.bound)
    actuator.set_controller_gains(PdControllerGains(p=0.0, d=DAMPING))
    plant.Finalize()
    simulator, context = started(builder, plant)
    plant.get_desired_state_input_port(default_model_instance()).FixValue(context, [0.0, 0.0])
    force = plant.get_applied_generalized_force_input_port()
    rail.set_translation_rate(context, block.velocity)
    for step in range(block.steps):
        force.FixValue(context, [block.pull(step)])
        simulator.AdvanceTo((step + 1) * block.step)
        yield rail.get_translation(context), rail.get_translation_rate(context)


def contact(block, options):
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, block.step)
    body, rub = with_block(plant, block, block.gravity), CoulombFriction(block.friction, block.friction)
    plant.RegisterCollisionGeometry(plant.world_body(), RigidTransform(), HalfSpace(), "ground", rub)
    for number, (x, y) in enumerate(((-0.1, -0.1), (-0.1, 0.1), (0.1, -0.1), (0.1, 0.1))):
        place = RigidTransform([x, y, -0.09])
        plant.RegisterCollisionGeometry(body, place, Sphere(0.01), "foot {}".format(number), rub)
    plant.Finalize()
    simulator, context = started(builder, plant)
    plant.SetFreeBodyPose(context, body, RigidTransform([0, 0, 0.1]))
    force, begin = plant.get_applied_generalized_force_input_port(), 0.0
    for step in range(-block.settling, block.steps):
        if step == 0:
            begin = plant.GetPositions(context)[4]
            velocities = plant.GetVelocities(context)
            velocities[3] = block.velocity
            plant.SetVelocities(context, velocities)
        along, up = block.forces(step)
        force.FixValue(context, np.array([0, 0, 0, along, 0, up]))
        simulator.AdvanceTo((step + 1 + block.settling) * block.step)
        if step >= 0:
            yield plant.GetPositions(context)[4] - begin, plant.GetVelocities(context)[3]


run({"joint": joint, "contact": contact})
