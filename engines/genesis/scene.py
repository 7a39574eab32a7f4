"""Scenes as users of Genesis write them: a plane and boxes as entities, joints and what slides as MJCF models."""

import math
from collections.abc import Iterable
from typing import Any
from xml.etree import ElementTree

from multibody_xval.engines.genesis.chains import as_choices, import_genesis
from multibody_xval.engines.interface.scene import (
    BELT,
    FINGER,
    FINGER_MASS,
    GRAVITY,
    ArmScene,
    ContactScene,
    JointScene,
    SceneSetting,
    SteppedWorld,
    Vector,
    along,
)
from multibody_xval.engines.mujoco.scene import joint_model

STEP = 0.01
"""Genesis's own time step [s]."""

RECIPE_OPTIONS = ("constraint_timeconst", "noslip_iterations", "friction_cone", "impratio")
"""Options of recipes, under the names that the rigid solver has for them."""

BELT_MASS = 1e6
"""Of a belt that moves on a slide, whatever acts on it [kg]."""


def _scene(setting: SceneSetting, gravity: float) -> Any:
    """Make an empty scene, with the options that the preset changes."""
    genesis = import_genesis()
    options = as_choices(setting.changes(*RECIPE_OPTIONS))
    return genesis.Scene(
        show_viewer=False,
        sim_options=genesis.options.SimOptions(dt=setting.time_step, gravity=(0, 0, -gravity)),
        rigid_options=genesis.options.RigidOptions(use_hibernation=setting.sleeping, **options),
    )


def contacts(scene: ContactScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with contacts."""
    genesis, world = import_genesis(), _scene(setting, GRAVITY)
    rub = {"friction": scene.friction}

    def add(morph: Any, **mass: float) -> Any:
        return world.add_entity(morph, material=genesis.materials.Rigid(**rub, **mass))

    slides: Any = None
    if scene.grip:
        reach, height = scene.finger
        sides = tuple(2 * half for half in FINGER)
        add(genesis.morphs.Box(size=sides, pos=(-reach, 0, height), fixed=True))
        slides = add(genesis.morphs.MJCF(file=_sliding_box(FINGER, FINGER_MASS, (reach, 0, height))))
    elif scene.belt:
        slides = add(genesis.morphs.MJCF(file=_sliding_box(BELT, BELT_MASS, (0, 0, -BELT[2]))))
    else:
        add(genesis.morphs.Plane(normal=scene.normal))
    for mass, half, place in scene.stack:
        morph = genesis.morphs.Box(size=tuple(2 * own for own in half), pos=place, quat=scene.orientation)
        followed = add(morph, rho=mass / (8 * math.prod(half)))
    world.build()
    if scene.belt:
        slides.set_dofs_velocity([scene.belt])
    if scene.grip:
        slides.control_dofs_force([-scene.grip])

    def launch(velocity: Vector, spin: float) -> None:
        followed.set_dofs_velocity([*velocity, 0.0, 0.0, spin])

    def state() -> Any:
        return followed.get_pos().numpy(), followed.get_quat().numpy(), followed.get_vel().numpy()

    def push(force: float) -> None:
        followed.base_link.apply_external_force(along(scene, force))

    return SteppedWorld(world.step, state, launch, world.destroy, push)


def joints(scene: JointScene | ArmScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with joints."""
    single = isinstance(scene, JointScene)
    world = _scene(setting, 0.0 if single else GRAVITY)
    model = ElementTree.fromstring(joint_model(scene, setting))
    hardness = setting.changed("solimplimit")
    for joint in model.iter("joint") if hardness else ():
        joint.set("solimplimit", _text(hardness))
    arm = world.add_entity(import_genesis().morphs.MJCF(file=model, **setting.changes("default_armature")))
    world.build()
    if isinstance(scene, JointScene):
        arm.control_dofs_force([scene.load])
    if scene.velocity:
        arm.set_dofs_velocity([scene.velocity])

    def state() -> Any:
        return (arm.get_dofs_position().numpy(),)

    return SteppedWorld(world.step, state, close=world.destroy)


def _sliding_box(half: Vector, mass: float, place: Vector) -> ElementTree.Element:
    """Give an MJCF model of a box on a slide along x."""
    joint = '<joint type="slide" axis="1 0 0"/>'
    box = f'<geom type="box" size="{_text(half)}" mass="{mass}"/>'
    return ElementTree.fromstring(
        f'<mujoco><worldbody><body pos="{_text(place)}">{joint}{box}</body></worldbody></mujoco>'
    )


def _text(numbers: Iterable[float]) -> str:
    return " ".join(map(repr, numbers))
