"""The boxes of a scene as columns of data, for engines in another Python."""

from collections.abc import Sequence
from typing import Any

from multibody_xval.engines.interface.scene import (
    BELT,
    FINGER,
    FINGER_MASS,
    GRAVITY,
    LEVEL,
    ContactScene,
    Quaternion,
    Vector,
)


def solids(scene: ContactScene) -> dict[str, Any]:
    """Give columns of every box that moves, the followed one last, and the forces.

    Columns are sides [m], mass [kg], place [m], orientation and velocity [m/s]. The first box of a scene with a belt
    is driven, whatever acts on it; with a grip it is pressed on a slider along x, and a fixed one as large is at
    ``wall``. Where there is a plane, ``normal`` is its own.
    """
    boxes: list[tuple[Sequence[float], float, Vector, Quaternion]] = []
    fixed: dict[str, Any] = {"normal": scene.normal}
    if scene.grip:
        reach, height = scene.finger
        fixed = {"wall": (-reach, 0.0, height)}
        boxes.append(([2 * half for half in FINGER], FINGER_MASS, (reach, 0.0, height), LEVEL))
    elif scene.belt:
        fixed = {}
        boxes.append(([2 * half for half in BELT], 1.0, (0.0, 0.0, -BELT[2]), LEVEL))
    for mass, half, place in scene.stack:
        boxes.append(([2 * own for own in half], mass, place, scene.orientation))
    columns = zip(("size", "mass", "place", "orientation"), zip(*boxes, strict=True), strict=True)
    moving = [(scene.belt if box == 0 else 0.0, 0.0, 0.0) for box in range(len(boxes))]
    acting = {"friction": scene.friction, "belt": scene.belt, "grip": scene.grip, "gravity": GRAVITY}
    return {**dict(columns), **acting, **fixed, "velocity": moving, "forward": scene.forward}
