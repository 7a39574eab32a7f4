"""Scenes as users of PyBullet write them: boxes as multi-bodies, and joints in URDF.

The friction that a URDF states is ignored; the recipe has motors of target zero.
"""

import math
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from multibody_xval.engines.interface.scene import (
    BELT,
    FINGER,
    FINGER_MASS,
    GRAVITY,
    GROUND,
    LEVEL,
    LINK_INERTIA,
    LINK_LENGTH,
    LINK_MASS,
    ArmScene,
    ContactScene,
    JointScene,
    Quaternion,
    SceneSetting,
    SteppedWorld,
    Vector,
    along,
)
from multibody_xval.engines.pybullet.joint import import_pybullet

STEP = 1 / 240
"""PyBullet's own time step [s]."""

DAMPING, ANCHOR = ("linearDamping", "angularDamping"), "frictionAnchor"
"""Options of a body, together as PyBullet takes them: a call that sets a coefficient forgets the anchor."""

BELT_FORCE = 1e9
"""Of the motor that drives a belt, whatever acts on it [N]."""


def _connected(setting: SceneSetting, gravity: float) -> Any:
    """Open a connection, with what the preset changes of it."""
    bullet = import_pybullet(alone=True)
    bullet.connect(bullet.DIRECT)
    bullet.setGravity(0, 0, -gravity)
    bullet.setTimeStep(setting.time_step)
    threshold = setting.changed("solverResidualThreshold")
    if threshold is not None:
        bullet.setPhysicsEngineParameter(solverResidualThreshold=threshold)
    return bullet


def _set_dynamics(bullet: Any, setting: SceneSetting, body: int, link: int) -> None:
    """Set what the preset changes of a body."""
    damping, anchor = setting.changes(*DAMPING), setting.changes(ANCHOR)
    if damping:
        bullet.changeDynamics(body, link, **damping)
    if anchor:
        bullet.changeDynamics(body, link, **anchor)
    if setting.sleeping:
        bullet.changeDynamics(body, link, activationState=bullet.ACTIVATION_STATE_ENABLE_SLEEPING)


def _set_friction(bullet: Any, body: int, link: int, friction: float) -> None:
    """Set the root of a coefficient, which another body's multiplies."""
    bullet.changeDynamics(body, link, lateralFriction=math.sqrt(friction))


def _add_box(
    bullet: Any, setting: SceneSetting, half: Sequence[float], mass: float, place: Vector, turned: Quaternion,
    friction: float,
) -> int:  # fmt: skip
    """Add a box; one without mass is fixed."""
    shape = bullet.createCollisionShape(bullet.GEOM_BOX, halfExtents=half)
    body = int(bullet.createMultiBody(mass, shape, -1, place, (*turned[1:], turned[0])))
    _set_friction(bullet, body, -1, friction)
    _set_dynamics(bullet, setting, body, -1)
    return body


def _add_links(
    bullet: Any, kind: int, axis: Vector, places: Sequence[Vector], mass: float, *, centre: Vector = (0.0, 0.0, 0.0),
    base: Vector = (0.0, 0.0, 0.0), shape: int = -1,
) -> int:  # fmt: skip
    """Add links in a row on a fixed base, a joint each, whose motors are off."""
    number = len(places)
    body = int(bullet.createMultiBody(
        0, -1, -1, base, linkMasses=[mass] * number, linkCollisionShapeIndices=[shape] * number,
        linkVisualShapeIndices=[-1] * number, linkPositions=places, linkOrientations=[[0, 0, 0, 1]] * number,
        linkInertialFramePositions=[centre] * number, linkInertialFrameOrientations=[[0, 0, 0, 1]] * number,
        linkParentIndices=list(range(number)), linkJointTypes=[kind] * number, linkJointAxis=[axis] * number,
    ))  # fmt: skip
    for joint in range(number):
        bullet.setJointMotorControl2(body, joint, bullet.VELOCITY_CONTROL, force=0)
    return body


def _add_slider(
    bullet: Any, setting: SceneSetting, half: Sequence[float], mass: float, place: Vector, friction: float
) -> int:
    """Add a box on a slide along x."""
    shape = bullet.createCollisionShape(bullet.GEOM_BOX, halfExtents=half)
    body = _add_links(bullet, bullet.JOINT_PRISMATIC, (1, 0, 0), [(0, 0, 0)], mass, base=place, shape=shape)
    _set_friction(bullet, body, 0, friction)
    _set_dynamics(bullet, setting, body, 0)
    return body


def contacts(scene: ContactScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with contacts."""
    bullet, rub = _connected(setting, GRAVITY), scene.friction
    if scene.grip:
        reach, height = scene.finger
        _add_box(bullet, setting, FINGER, 0, (-reach, 0, height), LEVEL, rub)
        pressed = _add_slider(bullet, setting, FINGER, FINGER_MASS, (reach, 0, height), rub)
    elif scene.belt:
        belt = _add_slider(bullet, setting, BELT, 1e4, (0, 0, -BELT[2]), rub)
        bullet.setJointMotorControl2(belt, 0, bullet.VELOCITY_CONTROL, targetVelocity=scene.belt, force=BELT_FORCE)
        bullet.resetJointState(belt, 0, 0, scene.belt)
    else:
        x, y, z = scene.normal
        _add_box(bullet, setting, (GROUND, GROUND, 1), 0, (-x, -y, -z), scene.tilt, rub)
    for mass, half, place in scene.stack:
        body = _add_box(bullet, setting, half, mass, place, scene.orientation, rub)

    def step() -> None:
        if scene.grip:
            bullet.setJointMotorControl2(pressed, 0, bullet.TORQUE_CONTROL, force=-scene.grip)
        bullet.stepSimulation()

    def state() -> Any:
        place, (x, y, z, w) = bullet.getBasePositionAndOrientation(body)
        return place, (w, x, y, z), bullet.getBaseVelocity(body)[0]

    def launch(velocity: Vector, spin: float) -> None:
        bullet.resetBaseVelocity(body, velocity, (0, 0, spin))

    def push(force: float) -> None:
        centre = bullet.getBasePositionAndOrientation(body)[0]
        bullet.applyExternalForce(body, -1, along(scene, force), centre, bullet.WORLD_FRAME)

    return SteppedWorld(step, state, launch, bullet.disconnect, push)


def joint_model(scene: JointScene | ArmScene) -> str:
    """Write a scene with joints in URDF."""
    kind, axis, centre, inertia = "continuous", "0 1 0", LINK_LENGTH / 2, LINK_INERTIA
    if isinstance(scene, JointScene):
        kind, axis = ("continuous", "0 0 1") if scene.kind == "hinge" else ("prismatic", "1 0 0")
        centre, inertia = 0.0, (1.0, 1.0, 1.0)
    bounds = (scene.friction,) if isinstance(scene, JointScene) else scene.friction
    x, y, z = inertia
    body = (
        f'<inertial> <origin xyz="{centre} 0 0"/> <mass value="{LINK_MASS}"/> '
        f'<inertia ixx="{x!r}" iyy="{y!r}" izz="{z!r}" ixy="0" ixz="0" iyz="0"/> </inertial> </link>'
    )
    links = [
        f'<link name="link{number}"> {body}<joint name="joint{number}" type="{kind}"> '
        f'<parent link="link{number - 1}"/> <child link="link{number}"/> '
        f'<origin xyz="{LINK_LENGTH if number > 1 else 0.0} 0 0"/> <axis xyz="{axis}"/> '
        f'<limit lower="-1e6" upper="1e6" effort="1e9" velocity="1e9"/> '
        f'<dynamics damping="{scene.damping}" friction="{bound!r}"/> </joint>'
        for number, bound in enumerate(bounds, 1)
    ]
    return f'<robot name="joints"><link name="link0"> {body}{"".join(links)}</robot>'


def _loaded(bullet: Any, model: str) -> int:
    """Load a URDF as it is written: without the flag, Bullet has inertias of its own."""
    with TemporaryDirectory() as folder:
        file = Path(folder) / "joints.urdf"
        file.write_text(model, encoding="utf-8")
        return int(bullet.loadURDF(str(file), useFixedBase=True, flags=bullet.URDF_USE_INERTIA_FROM_FILE))


def joints(scene: JointScene | ArmScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with joints."""
    single = isinstance(scene, JointScene)
    bullet = _connected(setting, 0.0 if single else GRAVITY)
    bounds = [scene.friction] if isinstance(scene, JointScene) else scene.friction
    body = _loaded(bullet, joint_model(scene))
    for joint, bound in enumerate(bounds):
        _set_dynamics(bullet, setting, body, joint)
        motor = bound if setting.changed("dry friction") else 0.0
        bullet.setJointMotorControl2(body, joint, bullet.VELOCITY_CONTROL, targetVelocity=0, force=motor)
        bullet.resetJointState(body, joint, 0.0, scene.velocity)

    def step() -> None:
        if isinstance(scene, JointScene):
            bullet.setJointMotorControl2(body, 0, bullet.TORQUE_CONTROL, force=scene.load)
        bullet.stepSimulation()

    def state() -> Any:
        return ([each[0] for each in bullet.getJointStates(body, range(len(bounds)))],)

    return SteppedWorld(step, state, close=bullet.disconnect)
