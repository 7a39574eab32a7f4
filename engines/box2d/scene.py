"""Scenes as users of Box2D write them, in the plane: polygons, and motors of bounded force in joints."""

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
)
from multibody_xval.engines.shared.planar_scene import check_planar, hinge_angles, in_plane, row

STEP = 1 / 60
"""Of Box2D's manual [s]; it has no default."""

UNIT_INERTIA = 6**0.5 / 2
"""Half the side of a square of 1 kg with an inertia of 1 kg m² [m]."""

LINK_HALF = (LINK_LENGTH / 2, 0.005)
"""Half sides of a link [m]."""


class _World:
    """A world, and its step."""

    def __init__(self, setting: SceneSetting, gravity: float):
        import Box2D

        self.box2d, self._setting = Box2D, setting
        self.world = Box2D.b2World(gravity=(0, -gravity), doSleep=setting.sleeping)
        self.still = self.world.CreateStaticBody()

    def fixture(self, half: Sequence[float], friction: float, mass: float = 0.0, *, touches: bool = True) -> Any:
        """Give a box; one without mass is of a body that is not moved by forces."""
        shape = self.box2d.b2PolygonShape(box=(half[0], half[-1]))
        density = mass / (4 * half[0] * half[-1])
        touching = {} if touches else {"filter": self.box2d.b2Filter(maskBits=0)}
        return self.box2d.b2FixtureDef(shape=shape, density=density, friction=friction, restitution=0.0, **touching)

    def free(self, place: tuple[float, float], angle: float, fixture: Any) -> Any:
        """Add a body; only its own switch keeps it from sleeping."""
        sleeping = self._setting.sleeping
        return self.world.CreateDynamicBody(position=place, angle=angle, fixtures=fixture, allowSleep=sleeping)

    def step(self) -> None:
        """Take a step."""
        iterations = (self._setting.preset[name] for name in ("velocityIterations", "positionIterations"))
        self.world.Step(self._setting.time_step, *iterations)
        self.world.ClearForces()


def contacts(scene: ContactScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with contacts."""
    check_planar(scene)
    own, rub, pressed = _World(setting, GRAVITY), scene.friction, None
    world = own.world
    if scene.grip:
        reach, height = scene.finger
        world.CreateStaticBody(position=(-reach, height), fixtures=own.fixture(FINGER, rub))
        pressed = own.free((reach, height), 0.0, own.fixture(FINGER, rub, FINGER_MASS))
        world.CreatePrismaticJoint(bodyA=own.still, bodyB=pressed, anchor=pressed.position, axis=(1, 0))
    elif scene.belt:
        belt = own.fixture(BELT, rub)
        world.CreateKinematicBody(position=(0, -0.1), linearVelocity=(scene.belt, 0), fixtures=belt)
    else:
        x, _, z = scene.normal
        world.CreateStaticBody(position=(-x, -z), angle=-scene.slope, fixtures=own.fixture((GROUND, 1.0), rub))
    for box, place in zip(scene.boxes, scene.places, strict=True):
        body = own.free((place[0], place[2]), -scene.slope, own.fixture([box.side / 2] * 2, rub, box.mass))

    def step() -> None:
        if pressed is not None:
            pressed.ApplyForceToCenter((-scene.grip, 0), True)
        own.step()

    def launch(velocity: Vector, spin: float) -> None:
        body.linearVelocity, body.awake = in_plane(velocity, spin), True

    def push(force: float) -> None:
        body.ApplyForceToCenter(scene.along(force)[::2], True)

    return SteppedWorld(step, lambda: row(body.position, body.angle, body.linearVelocity), launch, push=push)


def joints(scene: JointScene | ArmScene, setting: SceneSetting) -> SteppedWorld:
    """Build a scene with joints."""
    return _one_joint(scene, setting) if isinstance(scene, JointScene) else _arm(scene, setting)


def _one_joint(scene: JointScene, setting: SceneSetting) -> SteppedWorld:
    own, hinge = _World(setting, 0.0), scene.kind == "hinge"
    body = own.free((0, 0), 0.0, own.fixture((UNIT_INERTIA, UNIT_INERTIA), 0.0, 1.0, touches=False))
    motor: dict[str, Any] = {
        "bodyA": own.still,
        "bodyB": body,
        "anchor": (0, 0),
        "enableMotor": True,
        "motorSpeed": 0.0,
    }
    if hinge:
        own.world.CreateRevoluteJoint(**motor, maxMotorTorque=scene.friction)
    else:
        own.world.CreatePrismaticJoint(**motor, axis=(1, 0), maxMotorForce=scene.friction)

    def step() -> None:
        if hinge:
            body.ApplyTorque(scene.load, True)
        else:
            body.ApplyForceToCenter((scene.load, 0), True)
        own.step()

    return SteppedWorld(step, lambda: ([body.angle if hinge else body.position[0]],))


def _arm(scene: ArmScene, setting: SceneSetting) -> SteppedWorld:
    own = _World(setting, GRAVITY)
    before, links = own.still, []
    for link, bound in enumerate(scene.friction):
        rod = own.fixture(LINK_HALF, 0.0, LINK_MASS, touches=False)
        body = own.free((LINK_LENGTH * (link + 0.5), 0), 0.0, rod)
        own.world.CreateRevoluteJoint(
            bodyA=before,
            bodyB=body,
            anchor=(LINK_LENGTH * link, 0),
            enableMotor=True,
            motorSpeed=0.0,
            maxMotorTorque=bound,
        )
        links.append(body)
        before = body

    return SteppedWorld(own.step, lambda: (hinge_angles(link.angle for link in links),))
