"""Scenes as users of MuJoCo write them: a model in XML, with the attributes that the preset changes."""

from collections.abc import Iterable, Mapping
from typing import Any

from multibody_xval.engines.interface.scene import (
    FINGER,
    FINGER_MASS,
    GRAVITY,
    GROUND,
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

STEP = 0.002
"""MuJoCo's own time step [s]."""

MODEL_ATTRIBUTES = (
    "solver", "iterations", "tolerance", "cone", "impratio", "integrator", "noslip_iterations", "noslip_tolerance",
)  # fmt: skip
"""Options that are attributes of the model's ``option``."""

JOINT_ATTRIBUTES = {"solref_friction": "solreffriction", "solimp_friction": "solimpfriction"}
"""Options that are attributes of a joint, by the names that they have in XML."""

BELT_MASS = 1e6
"""Of a belt that moves on a slide, whatever acts on it [kg]."""


def contact_model(scene: ContactScene, setting: SceneSetting) -> str:
    """Write a scene with contacts in XML."""
    rub = f'friction="{scene.friction} 0.005 0.0001"'
    if hardness := written(setting, "solimp"):
        rub += f' solimp="{hardness}"'
    bodies = []
    if scene.grip:
        reach, height = scene.finger
        bodies.append(f'<geom type="box" size="{_text(FINGER)}" pos="{-reach} 0 {height}" {rub}/>')
    elif scene.belt:
        belt = f'<geom type="box" size="20 1 .1" mass="{BELT_MASS}" {rub}/>'
        bodies.append(f'<body pos="0 0 -.1"><joint name="belt" type="slide" axis="1 0 0"/>{belt}</body>')
    else:
        bodies.append(f'<geom type="plane" size="{GROUND} {GROUND} 1" quat="{_text(scene.tilt)}" {rub}/>')
    for mass, half, place in scene.stack:
        geom = f'<geom type="box" size="{_text(half)}" mass="{mass}" {rub}/>'
        free = "<freejoint/>"
        if place == scene.places[-1]:
            free, geom = '<freejoint name="box"/>', geom + _shaker(scene)
        bodies.append(f'<body pos="{_text(place)}" quat="{_text(scene.orientation)}">{free}{geom}</body>')
    if scene.grip:
        finger = f'<geom type="box" size="{_text(FINGER)}" mass="{FINGER_MASS}" {rub}/>'
        slide = '<joint name="finger" type="slide" axis="1 0 0"/>'
        bodies.insert(1, f'<body pos="{reach} 0 {height}">{slide}{finger}</body>')
    return _model(setting, bodies)


def _shaker(scene: ContactScene) -> str:
    """Write the mass inside a box; nothing where there is none."""
    if scene.shaker is None:
        return ""
    own = f'axis="1 0 0" stiffness="{scene.shaker.stiffness}" damping="{scene.shaker.damping}"'
    geom = f'<geom type="sphere" size=".01" mass="{scene.shaker.mass}" contype="0" conaffinity="0"/>'
    return f'<body><joint name="shaker" type="slide" {own}/>{geom}</body>'


def joint_model(scene: JointScene | ArmScene, setting: SceneSetting) -> str:
    """Write a scene with joints in XML."""
    attributes = {name: written(setting, option) for option, name in JOINT_ATTRIBUTES.items()}
    if scene.damping:
        attributes |= {"damping": str(scene.damping)} | _damped(attributes, setting, scene.damping)
    own = " ".join(f'{name}="{value}"' for name, value in attributes.items() if value)
    if isinstance(scene, JointScene):
        axis = "0 0 1" if scene.kind == "hinge" else "1 0 0"
        joint = f'<joint type="{scene.kind}" axis="{axis}" frictionloss="{scene.friction}" {own}/>'
        return _model(setting, [f'<body><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>{joint}</body>'], 0.0)
    inertial = f'<inertial pos="{LINK_LENGTH / 2} 0 0" mass="{LINK_MASS}" diaginertia="{_text(LINK_INERTIA)}"/>'
    links = [
        f'<body pos="{LINK_LENGTH if link else 0} 0 0">{inertial}'
        f'<joint type="hinge" axis="0 1 0" frictionloss="{bound!r}" {own}/>'
        for link, bound in enumerate(scene.friction)
    ]
    return _model(setting, [*links, "</body>" * scene.links])


def _damped(attributes: Mapping[str, str], setting: SceneSetting, damping: float) -> dict[str, str]:
    """Give the recipe of a joint with damping and an inertia of 1: the direct form, with which one step stops a slip.

    MuJoCo applies damping after friction, and makes that part of a step 1 + damping × step / inertia times less.
    """
    rate = 1 / setting.time_step + damping
    return {"solreffriction": _text([-rate, -rate])} if attributes["solreffriction"] else {}


def _model(setting: SceneSetting, bodies: Iterable[str], gravity: float = GRAVITY) -> str:
    changed = {name: written(setting, name) for name in MODEL_ATTRIBUTES}
    attributes = " ".join(f'{name}="{value}"' for name, value in changed.items() if value)
    sleep = '<flag sleep="enable"/>' if setting.sleeping else ""
    option = f'<option timestep="{setting.time_step}" gravity="0 0 {-gravity}" {attributes}>{sleep}</option>'
    return f"<mujoco>{option}<worldbody>{''.join(bodies)}</worldbody></mujoco>"


def written(setting: SceneSetting, option: str) -> str:
    """Write the value of an option that the preset changes; an empty text where it does not."""
    value = setting.changed(option)
    return "" if value is None else value if isinstance(value, str) else _text(value)


def _text(values: Any) -> str:
    several = [values] if isinstance(values, int | float) else values
    return " ".join(repr(value).removesuffix(".0") for value in several)


def contact_world(scene: ContactScene, setting: SceneSetting) -> tuple[Any, Any]:
    """Compile a scene with contacts; gives the model and its data. The joint of the followed box is ``box``."""
    import mujoco

    model = mujoco.MjModel.from_xml_string(contact_model(scene, setting))
    data = mujoco.MjData(model)
    if scene.belt:
        data.joint("belt").qvel[0] = scene.belt
    if scene.grip:
        data.joint("finger").qfrc_applied[0] = -scene.grip
    return model, data


def joint_world(scene: JointScene | ArmScene, setting: SceneSetting) -> tuple[Any, Any]:
    """Compile a scene with joints; gives the model and its data."""
    import mujoco

    model = mujoco.MjModel.from_xml_string(joint_model(scene, setting))
    data = mujoco.MjData(model)
    if isinstance(scene, JointScene):
        data.qfrc_applied[0], data.qvel[0] = scene.load, scene.velocity
    return model, data


def contacts(scene: ContactScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with contacts."""
    import mujoco

    model, data = contact_world(scene, setting)
    box = data.joint("box")

    def launch(velocity: Vector, spin: float) -> None:
        box.qvel[:] = *velocity, 0.0, 0.0, spin

    def push(force: float) -> None:
        if scene.shaker:
            data.joint("shaker").qfrc_applied[0] = force
        else:
            data.xfrc_applied[-1, :3] = along(scene, force)

    def state() -> Any:
        return box.qpos[:3], box.qpos[3:], box.qvel[:3]

    def step() -> None:
        mujoco.mj_step(model, data)

    return SteppedWorld(step, state, launch, push=push)


def joints(scene: JointScene | ArmScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with joints."""
    import mujoco

    model, data = joint_world(scene, setting)

    def step() -> None:
        mujoco.mj_step(model, data)

    def state() -> Any:
        return (data.qpos,)

    return SteppedWorld(step, state)
