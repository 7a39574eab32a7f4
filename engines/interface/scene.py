"""Small rigid-body scenes as users write them, as plain data, and what an engine makes of one.

The world's z axis points up. A slope is turned about y, so that it falls towards +x; boxes lie on it, or are held by
two fingers. Joints with dry friction are loaded one by one, or carry an arm.
"""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

import numpy as np

from multibody_xval.engines.interface.presets import Formulation, Preset
from reference_lcp.errors import ParameterError, checked_choice
from reference_lcp.validation import FloatArray, checked_scalar

GRAVITY = 9.81
"""g [m/s²]."""

LINK_LENGTH, LINK_MASS = 0.2, 1.0
"""Of the links of an arm [m], [kg]."""

LINK_INERTIA = (1e-5, LINK_MASS * LINK_LENGTH**2 / 12, LINK_MASS * LINK_LENGTH**2 / 12)
"""Of a link about its centre, along x, y and z [kg m²]: a thin rod along x."""

GROUND = 50.0
"""Half of the side of a ground that has one [m]."""

FINGER_MASS = 0.5
"""Of the finger that presses [kg]."""

FINGER = (0.02, 0.1, 0.1)
"""Half sides of a finger [m]."""

BELT = (20.0, 1.0, 0.1)
"""Half sides of a belt, whose upper face is at zero [m]."""

RIGHT_ANGLE = math.pi / 2

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
"""(w, x, y, z)."""

LEVEL: Quaternion = (1.0, 0.0, 0.0, 0.0)
"""Not turned."""


def turned_about(axis: int, angle: float) -> Quaternion:
    """Give the quaternion of a turn by `angle` [rad] about x (0), y (1) or z (2)."""
    parts = [math.cos(angle / 2), 0.0, 0.0, 0.0]
    parts[1 + axis] = math.sin(angle / 2)
    return parts[0], parts[1], parts[2], parts[3]


@dataclass(frozen=True, kw_only=True)
class Box:
    """A body of uniform density that is free to move: a cube, or a box that is longer or shorter along its x axis."""

    mass: float = 1.0
    """[kg]."""
    side: float = 0.2
    """[m]."""
    length: float | None = None
    """Side along its x axis, where that is another one [m]."""

    def __post_init__(self) -> None:
        checked_scalar("mass", self.mass, "> 0")
        checked_scalar("side", self.side, "> 0")
        if self.length is not None:
            checked_scalar("length", self.length, "> 0")

    @property
    def half(self) -> Vector:
        """Half sides along x, y and z [m]."""
        return (self.length or self.side) / 2, self.side / 2, self.side / 2


@dataclass(frozen=True, kw_only=True)
class Shaker:
    """A mass on a spring and a dashpot in the middle of a box, that slides along its x axis and touches nothing."""

    mass: float = 0.1
    """[kg]."""
    stiffness: float = 1000.0
    """[N/m]."""
    damping: float = 1.0
    """[N s/m]."""

    def __post_init__(self) -> None:
        for name in ("mass", "stiffness", "damping"):
            checked_scalar(name, getattr(self, name), "> 0")


@dataclass(frozen=True, kw_only=True)
class ContactScene:
    """Boxes that rest on a plane, one on the other, or one that two fingers hold; all surfaces rub alike."""

    friction: float = 0.5
    """Coefficient μ of every pair of surfaces."""
    boxes: tuple[Box, ...] = (Box(),)
    """From below; the last one is followed."""
    slope: float = 0.0
    """Angle of the plane [rad], in [0, π/2)."""
    turn: float = 0.0
    """Angle of the boxes about the plane's normal [rad]."""
    belt: float = 0.0
    """Velocity of the plane along x [m/s]: a wide box that is driven, whatever acts on it."""
    grip: float = 0.0
    """Force with which the right finger, on a prismatic joint, presses the only box against the left one, which is
    fixed [N]; there is no plane then. Zero without fingers."""
    shaker: Shaker | None = None
    """In the last box."""

    def __post_init__(self) -> None:
        checked_scalar("friction", self.friction, ">= 0")
        checked_scalar("grip", self.grip, ">= 0")
        if not 0 <= self.slope < RIGHT_ANGLE:
            raise ParameterError(f"slope = {math.degrees(self.slope):g}°; allowed: >= 0 and < 90°")
        if not self.boxes or (self.grip and len(self.boxes) > 1):
            raise ParameterError(f"boxes = {len(self.boxes)}; allowed: {'1 in a grip' if self.grip else '>= 1'}")

    @property
    def normal(self) -> Vector:
        """Unit normal of the plane."""
        return math.sin(self.slope), 0.0, math.cos(self.slope)

    @property
    def downhill(self) -> Vector:
        """Unit vector that points down the plane; x where it is level."""
        return math.cos(self.slope), 0.0, -math.sin(self.slope)

    @property
    def forward(self) -> Vector:
        """Unit vector along the boxes' own x axis, which points down the plane where they are not turned."""
        x, _, z = self.downhill
        return math.cos(self.turn) * x, math.sin(self.turn), math.cos(self.turn) * z

    @property
    def tilt(self) -> Quaternion:
        """Of the plane."""
        return turned_about(1, self.slope)

    @property
    def orientation(self) -> Quaternion:
        """Of the boxes: turned about the plane's normal, then tilted."""
        cosine, sine = math.cos(self.slope / 2), math.sin(self.slope / 2)
        across, along = math.cos(self.turn / 2), math.sin(self.turn / 2)
        return cosine * across, sine * along, sine * across, cosine * along

    @property
    def places(self) -> list[Vector]:
        """Centres of the boxes [m]: each just touches what is below it, or both fingers."""
        heights, top = [], 0.0
        for box in self.boxes:
            heights.append(1.0 if self.grip else top + box.side / 2)
            top += box.side
        x, y, z = (0.0, 0.0, 1.0) if self.grip else self.normal
        return [(x * height, y * height, z * height) for height in heights]

    @property
    def stack(self) -> list[tuple[float, Vector, Vector]]:
        """Mass [kg], half sides [m] and centre [m] of every box, from below."""
        return [(box.mass, box.half, place) for box, place in zip(self.boxes, self.places, strict=True)]

    @property
    def finger(self) -> tuple[float, float]:
        """Distance of the fingers' centres from the middle, and their height [m]."""
        return self.boxes[0].half[0] + FINGER[0], self.places[0][2]


def along(scene: ContactScene, force: float) -> Vector:
    """Give a force along the boxes' own x axis [N] in the axes of the world."""
    x, y, z = scene.forward
    return force * x, force * y, force * z


@dataclass(frozen=True, kw_only=True)
class JointScene:
    """One joint with dry friction, without gravity: under a constant load, or thrown."""

    kind: str = "hinge"
    """``hinge``, a body of 1 kg m² about z, or ``slide``, one of 1 kg along x."""
    friction: float = 1.0
    """Bound [N m] or [N]."""
    load: float = 0.0
    """[N m] or [N]."""
    damping: float = 0.0
    """Viscous, beside the friction [N m s] or [N s/m]."""
    velocity: float = 0.0
    """At the start [rad/s] or [m/s]."""

    def __post_init__(self) -> None:
        checked_choice("kind", self.kind, ("hinge", "slide"))
        checked_scalar("friction", self.friction, ">= 0")
        checked_scalar("damping", self.damping, ">= 0")
        checked_scalar("velocity", self.velocity)


@dataclass(frozen=True, kw_only=True)
class ArmScene:
    """Hinges in a row about y under gravity, the links stretched out along x: thin rods.

    Its coordinates are the angles of the hinges, or of two that tell as much.
    """

    friction: tuple[float, ...]
    """Bounds of the hinges [N m], from the base."""
    damping: ClassVar[float] = 0.0
    velocity: ClassVar[float] = 0.0

    def __post_init__(self) -> None:
        if not self.friction or min(self.friction) < 0:
            raise ParameterError(f"friction = {self.friction}; allowed: >= 0, one a hinge, at least one")

    @property
    def links(self) -> int:
        """How many there are."""
        return len(self.friction)


Scene = ContactScene | JointScene | ArmScene


def nothing() -> None:
    """Do nothing: there is nothing to free."""


def not_launched(velocity: Vector, spin: float) -> None:
    """Refuse to launch what is no box."""
    raise ParameterError(f"launch = {velocity}, {spin} of a joint; allowed: of a box")


def not_pushed(force: float) -> None:
    """Refuse to push what is no box."""
    raise ParameterError(f"force = {force:g} N on a joint; allowed: on a box")


class SceneWorld(Protocol):
    """A scene in an engine."""

    def run(self, steps: int) -> FloatArray:
        """Take so many steps, and give a row a step.

        Of a `ContactScene`, shape (steps, 10): position of the followed box [m], its orientation (w, x, y, z) and
        the velocity of its centre [m/s], in the world. Of joints, shape (steps, joints): coordinates [rad] or [m].
        """
        ...

    def launch(self, velocity: Vector, spin: float) -> object:
        """Give the followed box a velocity [m/s], and an angular one about the vertical [rad/s]."""
        ...

    def push(self, force: float) -> object:
        """Push the followed box along its own x axis in the next step [N]: its shaker, where it has one."""
        ...

    def close(self) -> object:
        """Free what the engine holds."""
        ...


@dataclass(frozen=True)
class SteppedWorld:
    """A scene whose engine is stepped from here: a `SceneWorld` of functions."""

    step: Callable[[], object]
    state: Callable[[], Iterable[Any]]
    """Gives numbers or arrays that together are a row; see `SceneWorld.run`."""
    launch: Callable[[Vector, float], object] = not_launched
    close: Callable[[], object] = nothing
    push: Callable[[float], object] = not_pushed

    def run(self, steps: int) -> FloatArray:
        """Take steps one by one; see `SceneWorld.run`."""
        rows = []
        for _ in range(steps):
            self.step()
            rows.append(np.concatenate(tuple(self.state()), axis=None))
        return np.array(rows, dtype=np.float64)


@dataclass(frozen=True)
class SolvedWorld:
    """A scene whose engine takes all steps of a run itself: a `SceneWorld` of functions."""

    run: Callable[[int], FloatArray]
    close: Callable[[], object] = nothing
    launch: Callable[[Vector, float], object] = not_launched
    push: Callable[[float], object] = not_pushed


@dataclass(frozen=True)
class SceneSetting:
    """How an engine is to run a scene."""

    preset: Preset
    """Only options that hold in any model are read: those of its presets ``default`` and ``recommended``."""
    time_step: float
    """[s]."""
    sleeping: bool = False
    """Bodies that hardly move may be put to sleep, as far as the engine does that as it comes."""

    def changed(self, name: str) -> Any:
        """Give the value of an option as the engine takes it, where the preset sets one; ``None`` otherwise."""
        option = self.preset.options.get(name)
        unchanged = option is None or option.value == option.default
        return None if unchanged else self.preset.value(name, self.time_step)

    def changes(self, *names: str) -> dict[str, Any]:
        """Give those of these options that the preset sets, as the engine takes them."""
        return {name: value for name in names if (value := self.changed(name)) is not None}


SceneBuilder = Callable[[Any, SceneSetting], SceneWorld]
"""Builds the scenes of a formulation: `ContactScene`, or `JointScene` and `ArmScene`; raises `ParameterError` for one
that the engine cannot represent."""


def formulation_of(scene: Scene) -> Formulation:
    """Give the formulation whose presets a scene is run with."""
    return Formulation.CONTACT if isinstance(scene, ContactScene) else Formulation.JOINT
