"""Scenes as users of Box2D 3 write them, in the plane: boxes, and motors of bounded force in joints."""

from collections.abc import Sequence
from typing import Any

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
    SceneSetting,
    SteppedWorld,
    Vector,
    along,
)
from multibody_xval.engines.shared.planar_scene import check_planar, hinge_angles, in_plane, turned

STEP = 1 / 60
"""Of Box2D's manual [s]; it has no default."""

UNIT_INERTIA = 6**0.5 / 2
"""Half the side of a square of 1 kg with an inertia of 1 kg m² [m]."""

LINK_HALF = (LINK_LENGTH / 2, 0.005)
"""Half sides of a link [m]."""


def _new_world(setting: SceneSetting, gravity: float) -> Any:
    import pyb2d3

    world = pyb2d3.World(gravity=(0, -gravity), **setting.changes("contact_hertz"))
    world.sleeping_enabled = setting.sleeping
    return world


def _add_box(body: Any, half: Sequence[float], mass: float = 0.0, **surface: Any) -> Any:
    """Give a body a box; one without mass is of a body that is not moved by forces."""
    import pyb2d3

    shape = pyb2d3.shape_def(density=mass / (4 * half[0] * half[-1]), **surface)
    body.create_shape(shape, pyb2d3.box(half[0], half[-1]))
    return body


def contacts(scene: ContactScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with contacts."""
    import pyb2d3

    check_planar(scene)
    world, (x, _, z), tilted = _new_world(setting, GRAVITY), scene.normal, pyb2d3.Rot()
    tilted.c, tilted.s = z, -x  # make_rot(angle) is off by up to 0.0016 rad
    rough = pyb2d3.surface_material(friction=scene.friction, restitution=0.0)
    if scene.grip:
        reach, height = scene.finger
        _add_box(world.create_static_body(position=(-reach, height)), FINGER, material=rough)
        pressed = world.create_dynamic_body(position=(reach, height))
        _add_box(pressed, FINGER, FINGER_MASS, material=rough)
        world.create_prismatic_joint(world.create_static_body(position=(reach, height)), pressed, local_axis_a=(1, 0))
    elif scene.belt:
        belt = world.create_kinematic_body(position=(0, -0.1), linear_velocity=(scene.belt, 0))
        _add_box(belt, BELT, material=rough)
    else:
        _add_box(world.create_static_body(position=(-x, -z), rotation=tilted), (GROUND, 1.0), material=rough)
    for mass, half, place in scene.stack:
        body = world.create_dynamic_body(position=(place[0], place[2]), rotation=tilted)
        _add_box(body, half, mass, material=rough)

    def step() -> None:
        if scene.grip:
            pressed.apply_force_to_center((-scene.grip, 0))
        world.step(setting.time_step, setting.preset["sub_step_count"])

    def state() -> Any:
        place, speed = body.position, body.linear_velocity
        return (place[0], 0.0, place[1]), turned(body.angle), (speed[0], 0.0, speed[1])

    def launch(velocity: Vector, spin: float) -> None:
        body.linear_velocity = in_plane(velocity, spin)
        body.awake = True

    def push(force: float) -> None:
        body.apply_force_to_center(along(scene, force)[::2])

    return SteppedWorld(step, state, launch, push=push)


def joints(scene: JointScene | ArmScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with joints."""
    return _one_joint(scene, setting) if isinstance(scene, JointScene) else _arm(scene, setting)


def _one_joint(scene: JointScene, setting: SceneSetting) -> SteppedWorld:
    world, hinge = _new_world(setting, 0.0), scene.kind == "hinge"
    body = _add_box(world.create_dynamic_body(), (UNIT_INERTIA, UNIT_INERTIA), 1.0)
    # A rate, and so is that of a joint over its inertia of 1.
    body.angular_damping = body.linear_damping = scene.damping
    ends = world.create_static_body(), body
    if hinge:
        body.angular_velocity = scene.velocity
        joint = world.create_revolute_joint(*ends, enable_motor=True, motor_speed=0.0, max_motor_torque=scene.friction)
    else:
        body.linear_velocity = (scene.velocity, 0)
        joint = world.create_prismatic_joint(*ends, enable_motor=True, motor_speed=0.0, max_motor_force=scene.friction)

    def step() -> None:
        if hinge:
            body.apply_torque(scene.load)
        else:
            body.apply_force_to_center((scene.load, 0))
        world.step(setting.time_step, setting.preset["sub_step_count"])

    def state() -> Any:
        return ([joint.angle if hinge else joint.translation],)

    return SteppedWorld(step, state)


def _arm(scene: ArmScene, setting: SceneSetting) -> SteppedWorld:
    import pyb2d3

    world, end = _new_world(setting, GRAVITY), 0.0
    links: list[Any] = []
    before, untouched = world.create_static_body(), pyb2d3.make_filter(mask_bits=0)
    for bound in scene.friction:
        body = world.create_dynamic_body(position=(LINK_LENGTH * (len(links) + 0.5), 0))
        _add_box(body, LINK_HALF, LINK_MASS, filter=untouched)
        world.create_revolute_joint(
            before, body, local_anchor_a=(end, 0), local_anchor_b=(-LINK_LENGTH / 2, 0), enable_motor=True,
            motor_speed=0.0, max_motor_torque=bound,
        )  # fmt: skip
        links.append(body)
        before, end = body, LINK_LENGTH / 2

    def step() -> None:
        world.step(setting.time_step, setting.preset["sub_step_count"])

    def state() -> Any:
        return (hinge_angles(link.angle for link in links),)

    return SteppedWorld(step, state)
