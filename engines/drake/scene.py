"""Scenes as users of Drake write them: a plant with a scene graph, and actuators as dry friction of joints."""

from collections.abc import Callable
from typing import Any

import numpy as np

from multibody_xval.engines.interface.scene import (
    GRAVITY,
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
from multibody_xval.engines.shared.solids import solids

TIME_STEP = 0.001
"""Of most of Drake's own examples [s]; a plant has no default."""

BELT_MASS = 1e5
"""Of a belt that slides, whatever acts on it [kg]."""


def contacts(scene: ContactScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with contacts."""
    from pydrake import all as drake

    builder = drake.DiagramBuilder()
    plant, _ = drake.AddMultibodyPlantSceneGraph(builder, setting.time_step)
    plant.mutable_gravity_field().set_gravity_vector([0, 0, -GRAVITY])
    bodies = _add_solids(plant, scene, setting.changed("hydroelastic_modulus"))
    plant.Finalize()
    tolerance = setting.changed("v_stiction")
    if tolerance is not None:
        plant.set_stiction_tolerance(tolerance)
    if scene.grip or scene.belt:
        force = builder.AddSystem(drake.ConstantVectorSource([-scene.grip]))
        builder.Connect(force.get_output_port(), plant.get_actuation_input_port())
    pushes = [drake.ExternallyAppliedSpatialForce()]
    pushes[0].body_index = bodies[-1].index()
    simulator, step = _simulated(builder, setting.time_step)
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    turned = drake.Quaternion(np.array(scene.orientation) / np.linalg.norm(scene.orientation))
    for body, place in zip(bodies, scene.places, strict=True):
        plant.SetFreeBodyPose(context, body, drake.RigidTransform(turned, np.array(place)))
    if scene.belt:
        plant.GetJointByName("slide").set_translation_rate(context, scene.belt)

    def state() -> Any:
        pose = plant.EvalBodyPoseInWorld(context, bodies[-1])
        velocity = plant.EvalBodySpatialVelocityInWorld(context, bodies[-1]).translational()
        return pose.translation(), pose.rotation().ToQuaternion().wxyz(), velocity

    def launch(velocity: Vector, spin: float) -> None:
        motion = drake.SpatialVelocity(np.array([0.0, 0.0, spin]), np.array(velocity))
        plant.SetFreeBodySpatialVelocity(context, bodies[-1], motion)

    def push(force: float) -> None:
        pushes[0].F_Bq_W = drake.SpatialForce(np.zeros(3), np.array(along(scene, force)))
        plant.get_applied_spatial_force_input_port().FixValue(context, pushes)

    return SteppedWorld(step, state, launch, push=push)


def _add_solids(plant: Any, scene: ContactScene, modulus: float | None) -> list[Any]:
    """Add the plane, the belt or the fingers, and the boxes; gives the bodies of these."""
    from pydrake import all as drake

    def surface(rigid: bool, size: float = 1.0) -> Any:
        """Make a surface with friction; with a modulus it touches in patches, and needs the smallest half side [m]."""
        properties = drake.ProximityProperties()
        drake.AddContactMaterial(friction=drake.CoulombFriction(scene.friction, scene.friction), properties=properties)
        if modulus is not None and rigid:
            drake.AddRigidHydroelasticProperties(1.0, properties)
        elif modulus is not None:
            drake.AddCompliantHydroelasticProperties(size, modulus, properties)
        return properties

    free, given, world = [], solids(scene), plant.world_body()
    if "normal" in given:
        pose = drake.RigidTransform(drake.Quaternion(scene.tilt), np.zeros(3))
        plant.RegisterCollisionGeometry(world, pose, drake.HalfSpace(), "ground", surface(rigid=True))
    if scene.grip:
        wall = drake.RigidTransform(np.array(given["wall"]))
        plant.RegisterCollisionGeometry(world, wall, drake.Box(*given["size"][0]), "wall", surface(rigid=True))
    for number, sides in enumerate(given["size"]):
        led = number == 0 and bool(scene.grip or scene.belt)  # by a motor, along x
        mass = BELT_MASS if led and scene.belt else given["mass"][number]
        name, rubs = f"box {number}", surface(led, float(np.min(sides)) / 2)
        inertia = drake.SpatialInertia(mass, np.zeros(3), drake.UnitInertia.SolidBox(*sides))
        body = plant.AddRigidBody(name, inertia)
        plant.RegisterCollisionGeometry(body, drake.RigidTransform(), drake.Box(*sides), name, rubs)
        if led:
            place = drake.RigidTransform(np.array(given["place"][number]))
            frame = plant.AddFrame(drake.FixedOffsetFrame("begin", plant.world_frame(), place))
            slide = plant.AddJoint(drake.PrismaticJoint("slide", frame, body.body_frame(), [1, 0, 0]))
            plant.AddJointActuator("push", slide)
        else:
            free.append(body)
    return free


def _simulated(builder: Any, time_step: float) -> tuple[Any, Callable[[], object]]:
    """Build the diagram; gives its simulator, and what takes a step."""
    from pydrake import all as drake

    simulator, steps = drake.Simulator(builder.Build()), 0
    simulator.Initialize()

    def step() -> None:
        nonlocal steps
        steps += 1
        simulator.AdvanceTo(steps * time_step)

    return simulator, step


def joints(scene: JointScene | ArmScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with joints: actuators with a gain of velocity and an effort limit, for Drake has no dry friction.

    A single joint is loaded by the weight of its body, beside the axis of a hinge.
    """
    from pydrake import all as drake

    builder = drake.DiagramBuilder()
    plant = builder.AddSystem(drake.MultibodyPlant(setting.time_step))
    bounds = [scene.friction] if isinstance(scene, JointScene) else scene.friction
    if isinstance(scene, JointScene):
        gravity, each = _single(scene)
    else:
        gravity = [0.0, 0.0, -GRAVITY]
        centre, inertia = [LINK_LENGTH / 2, 0.0, 0.0], drake.RotationalInertia(*LINK_INERTIA)
        each = drake.SpatialInertia.MakeFromCentralInertia(LINK_MASS, centre, inertia)
    plant.mutable_gravity_field().set_gravity_vector(gravity)
    slides = isinstance(scene, JointScene) and scene.kind == "slide"
    frame, bodies = plant.world_frame(), []
    for index, bound in enumerate(bounds):
        body = plant.AddRigidBody(f"body {index}", each)
        kind, axis = (drake.PrismaticJoint, [1, 0, 0]) if slides else (drake.RevoluteJoint, [0, 1, 0])
        joint = plant.AddJoint(kind(f"joint {index}", frame, body.body_frame(), axis, scene.damping))
        actuator = plant.AddJointActuator(f"friction {index}", joint, bound)
        actuator.set_controller_gains(drake.PdControllerGains(p=0.0, d=setting.preset["PdControllerGains.d"]))
        end = drake.RigidTransform([LINK_LENGTH, 0.0, 0.0])
        frame = plant.AddFrame(drake.FixedOffsetFrame(f"end {index}", body.body_frame(), end))
        bodies.append(body)
    plant.Finalize()
    still = builder.AddSystem(drake.ConstantVectorSource(np.zeros(2 * len(bounds))))
    model = plant.GetModelInstanceByName("DefaultModelInstance")
    builder.Connect(still.get_output_port(), plant.get_desired_state_input_port(model))
    simulator, step = _simulated(builder, setting.time_step)
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    plant.SetVelocities(context, [scene.velocity] * len(bounds))

    def state() -> Any:
        return (plant.GetPositions(context),)

    return SteppedWorld(step, state)


def _single(scene: JointScene) -> tuple[list[float], Any]:
    """Give gravity, and the inertia of a body of 1 kg that it loads a joint with."""
    from pydrake import all as drake

    if scene.kind == "slide":
        return [scene.load, 0.0, 0.0], drake.SpatialInertia(1.0, np.zeros(3), drake.UnitInertia(1, 1, 1))
    lever = scene.load / GRAVITY
    about_joint = drake.UnitInertia(1.0, 1 + lever**2, 1 + lever**2)
    return [0.0, 0.0, -GRAVITY], drake.SpatialInertia(1.0, np.array([lever, 0.0, 0.0]), about_joint)
