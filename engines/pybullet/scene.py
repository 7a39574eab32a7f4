"""Scenes as users of PyBullet write them: multi-bodies, and motors of target zero as dry friction of joints."""

import math
from collections.abc import Sequence
from functools import partial
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
)
from multibody_xval.engines.pybullet.joint import Connection

STEP = 1 / 240
"""PyBullet's own time step [s]."""

DYNAMICS = (("linearDamping", "angularDamping"), ("frictionAnchor",))
"""Options of a body, together as PyBullet takes them: a call that sets a coefficient forgets the anchor."""

BELT_FORCE = 1e9
"""Of the motor that drives a belt, whatever acts on it [N]."""


class _Scene:
    """One connection, with what the preset changes."""

    def __init__(self, setting: SceneSetting, gravity: float):
        self.bullet, self._setting = Connection(), setting
        self.bullet.setGravity(0, 0, -gravity)
        self.bullet.setTimeStep(setting.time_step)
        threshold = setting.changed("solverResidualThreshold")
        if threshold is not None:
            self.bullet.setPhysicsEngineParameter(solverResidualThreshold=threshold)

    def set_dynamics(self, body: int, link: int, friction: float | None = None) -> None:
        """Set the coefficient of a body, whose root others multiply it with, and what the preset changes."""
        change = partial(self.bullet.changeDynamics, body, link)
        if friction is not None:
            change(lateralFriction=math.sqrt(friction))
        for names in DYNAMICS:
            changed = {name: self._setting.changed(name) for name in names if self._setting.changed(name) is not None}
            if changed:
                change(**changed)
        if self._setting.sleeping:
            change(activationState=self.bullet.ACTIVATION_STATE_ENABLE_SLEEPING)

    def add_box(self, half: Sequence[float], mass: float, place: Vector, turned: Quaternion, friction: float) -> int:
        """Add a box; one without mass is fixed."""
        shape = self.bullet.createCollisionShape(self.bullet.GEOM_BOX, halfExtents=half)
        body = int(self.bullet.createMultiBody(mass, shape, -1, place, (*turned[1:], turned[0])))
        self.set_dynamics(body, -1, friction)
        return body

    def add_links(
        self, kind: int, axis: Vector, places: Sequence[Vector], mass: float, *, centre: Vector = (0.0, 0.0, 0.0),
        base: Vector = (0.0, 0.0, 0.0), half: Sequence[float] | None = None,
    ) -> int:  # fmt: skip
        """Add links in a row on a fixed base, a joint each, whose motors are off."""
        bullet, number = self.bullet, len(places)
        shape = -1
        if half is not None:
            shape = bullet.createCollisionShape(bullet.GEOM_BOX, halfExtents=half)
        body = int(bullet.createMultiBody(
            0, -1, -1, base, linkMasses=[mass] * number, linkCollisionShapeIndices=[shape] * number,
            linkVisualShapeIndices=[-1] * number, linkPositions=places, linkOrientations=[[0, 0, 0, 1]] * number,
            linkInertialFramePositions=[centre] * number, linkInertialFrameOrientations=[[0, 0, 0, 1]] * number,
            linkParentIndices=list(range(number)), linkJointTypes=[kind] * number, linkJointAxis=[axis] * number,
        ))  # fmt: skip
        for joint in range(number):
            self.set_motor(body, joint, force=0)
        return body

    def set_motor(self, body: int, joint: int, **motor: float) -> None:
        """Set the velocity motor of a joint, which is also its dry friction."""
        control = self.bullet.VELOCITY_CONTROL
        self.bullet.setJointMotorControl2(body, joint, control, **motor)

    def load(self, body: int, force: float) -> None:
        """Load the first joint for one step."""
        control = self.bullet.TORQUE_CONTROL
        self.bullet.setJointMotorControl2(body, 0, control, force=force)


def contacts(scene: ContactScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with contacts."""
    world = _Scene(setting, GRAVITY)
    bullet, rub = world.bullet, scene.friction
    pressed = -1
    if scene.grip:
        reach, height = scene.finger
        world.add_box(FINGER, 0, (-reach, 0, height), LEVEL, rub)
        slide = bullet.JOINT_PRISMATIC
        pressed = world.add_links(slide, (1, 0, 0), [(0, 0, 0)], FINGER_MASS, base=(reach, 0, height), half=FINGER)
        world.set_dynamics(pressed, 0, rub)
    elif scene.belt:
        belt = world.add_links(bullet.JOINT_PRISMATIC, (1, 0, 0), [(0, 0, 0)], 1e4, base=(0, 0, -BELT[2]), half=BELT)
        world.set_dynamics(belt, 0, rub)
        world.set_motor(belt, 0, targetVelocity=scene.belt, force=BELT_FORCE)
        bullet.resetJointState(belt, 0, 0, scene.belt)
    else:
        x, y, z = scene.normal
        world.add_box((GROUND, GROUND, 1), 0, (-x, -y, -z), scene.tilt, rub)
    for box, place in zip(scene.boxes, scene.places, strict=True):
        body = world.add_box([box.side / 2] * 3, box.mass, place, scene.orientation, rub)

    def step() -> None:
        if scene.grip:
            world.load(pressed, -scene.grip)
        bullet.stepSimulation()

    def state() -> Any:
        place, (x, y, z, w) = bullet.getBasePositionAndOrientation(body)
        return place, (w, x, y, z), bullet.getBaseVelocity(body)[0]

    def launch(velocity: Vector, spin: float) -> None:
        bullet.resetBaseVelocity(body, velocity, (0, 0, spin))

    def push(force: float) -> None:
        centre = bullet.getBasePositionAndOrientation(body)[0]
        bullet.applyExternalForce(body, -1, scene.along(force), centre, bullet.WORLD_FRAME)

    return SteppedWorld(step, state, launch, bullet.close, push)


def joints(scene: JointScene | ArmScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with joints."""
    single = isinstance(scene, JointScene)
    world = _Scene(setting, 0.0 if single else GRAVITY)
    bullet = world.bullet
    bounds = [scene.friction] if isinstance(scene, JointScene) else scene.friction
    if isinstance(scene, JointScene) and scene.kind == "slide":
        body = world.add_links(bullet.JOINT_PRISMATIC, (1, 0, 0), [(0, 0, 0)], 1.0)
    elif single:
        body = world.add_links(bullet.JOINT_REVOLUTE, (0, 0, 1), [(0, 0, 0)], 1.0)
    else:
        places = [(LINK_LENGTH if link else 0.0, 0.0, 0.0) for link in range(len(bounds))]
        centre = (LINK_LENGTH / 2, 0.0, 0.0)
        body = world.add_links(bullet.JOINT_REVOLUTE, (0, 1, 0), places, LINK_MASS, centre=centre)
    for joint, bound in enumerate(bounds):
        inertia = (1.0, 1.0, 1.0) if single else LINK_INERTIA
        bullet.changeDynamics(body, joint, localInertiaDiagonal=inertia)
        world.set_dynamics(body, joint)
        world.set_motor(body, joint, targetVelocity=0, force=bound)

    def step() -> None:
        if isinstance(scene, JointScene):
            world.load(body, scene.load)
        bullet.stepSimulation()

    def state() -> Any:
        return ([each[0] for each in bullet.getJointStates(body, range(len(bounds)))],)

    return SteppedWorld(step, state, close=bullet.close)
