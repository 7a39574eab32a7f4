"""Scenes as users of Drake write them: a plant with a scene graph, and actuators as dry friction of joints."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from multibody_xval.engines.interface.scene import (
    BELT,
    FINGER,
    FINGER_MASS,
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
)

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
    properties = _surfaces(scene.friction, setting)
    _add_surroundings(plant, scene, properties)
    bodies = [
        _add_box(plant, f"box {i}", [box.side / 2] * 3, box.mass, properties) for i, box in enumerate(scene.boxes)
    ]
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
        pushes[0].F_Bq_W = drake.SpatialForce(np.zeros(3), np.array(scene.along(force)))
        plant.get_applied_spatial_force_input_port().FixValue(context, pushes)

    return SteppedWorld(step, state, launch, push=push)


Properties = Callable[[bool, float], Any]
"""Gives the proximity properties of a rigid shape or of a compliant one, with its smallest half side [m]."""


def _surfaces(friction: float, setting: SceneSetting) -> Properties:
    """Give surfaces with friction; patches of contact, where the preset has them, need more."""
    from pydrake import all as drake

    modulus = setting.changed("hydroelastic_modulus")

    def properties(rigid: bool, size: float) -> Any:
        surface = drake.ProximityProperties()
        drake.AddContactMaterial(friction=drake.CoulombFriction(friction, friction), properties=surface)
        if modulus is not None and rigid:
            drake.AddRigidHydroelasticProperties(1.0, surface)
        elif modulus is not None:
            drake.AddCompliantHydroelasticProperties(size, modulus, surface)
        return surface

    return properties


def _add_surroundings(plant: Any, scene: ContactScene, properties: Properties) -> None:
    """Add the plane, the belt, or the fingers."""
    from pydrake import all as drake

    world = plant.world_body()
    if scene.grip:
        reach, height = scene.finger
        shape = drake.Box(*(2 * np.array(FINGER)))
        fixed = drake.RigidTransform([-reach, 0.0, height])
        plant.RegisterCollisionGeometry(world, fixed, shape, "finger", properties(True, FINGER[0]))
        _add_slide(plant, FINGER, FINGER_MASS, (reach, 0.0, height), properties)
    elif scene.belt:
        _add_slide(plant, BELT, BELT_MASS, (0.0, 0.0, -BELT[2]), properties)
    else:
        pose = drake.RigidTransform(drake.Quaternion(scene.tilt), np.zeros(3))
        plant.RegisterCollisionGeometry(world, pose, drake.HalfSpace(), "ground", properties(True, 1.0))


def _add_slide(plant: Any, half: Sequence[float], mass: float, place: Vector, properties: Properties) -> None:
    """Add a rigid box on a prismatic joint along x, with an actuator."""
    from pydrake import all as drake

    body = _add_box(plant, "slider", half, mass, lambda _, size: properties(True, size))
    frame = plant.AddFrame(drake.FixedOffsetFrame("begin", plant.world_frame(), drake.RigidTransform(np.array(place))))
    plant.AddJointActuator("push", plant.AddJoint(drake.PrismaticJoint("slide", frame, body.body_frame(), [1, 0, 0])))


def _add_box(plant: Any, name: str, half: Sequence[float], mass: float, properties: Properties) -> Any:
    from pydrake import all as drake

    sides = 2 * np.array(half)
    body = plant.AddRigidBody(name, drake.SpatialInertia(mass, np.zeros(3), drake.UnitInertia.SolidBox(*sides)))
    shape, pose = drake.Box(*sides), drake.RigidTransform()
    plant.RegisterCollisionGeometry(body, pose, shape, name, properties(False, float(np.min(half))))
    return body


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
        actuator = plant.AddJointActuator(
            f"friction {index}", plant.AddJoint(kind(f"joint {index}", frame, body.body_frame(), axis)), bound
        )
        actuator.set_controller_gains(drake.PdControllerGains(p=0.0, d=setting.preset["PdControllerGains.d"]))
        end = drake.RigidTransform([LINK_LENGTH, 0.0, 0.0])
        frame = plant.AddFrame(drake.FixedOffsetFrame(f"end {index}", body.body_frame(), end))
        bodies.append(body)
    plant.Finalize()
    still = builder.AddSystem(drake.ConstantVectorSource(np.zeros(2 * len(bounds))))
    model = plant.GetModelInstanceByName("DefaultModelInstance")
    builder.Connect(still.get_output_port(), plant.get_desired_state_input_port(model))
    simulator, step = _simulated(builder, setting.time_step)
    context = plant.GetMyContextFromRoot(simulator.get_context())
    return SteppedWorld(step, lambda: (plant.GetPositions(context),))


def _single(scene: JointScene) -> tuple[list[float], Any]:
    """Give gravity, and the inertia of a body of 1 kg that it loads a joint with."""
    from pydrake import all as drake

    if scene.kind == "slide":
        return [scene.load, 0.0, 0.0], drake.SpatialInertia(1.0, np.zeros(3), drake.UnitInertia(1, 1, 1))
    lever = scene.load / GRAVITY
    about_joint = drake.UnitInertia(1.0, 1 + lever**2, 1 + lever**2)
    return [0.0, 0.0, -GRAVITY], drake.SpatialInertia(1.0, np.array([lever, 0.0, 0.0]), about_joint)
