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
    """Give kind, half sides [m], mass [kg], place [m] and orientation of every box, the followed one last, and forces.

    A box is ``fixed``, ``pressed`` on a slider along x, ``driven``, whatever acts on it, or ``free``; where there is a
    plane, ``normal`` is its own.
    """
    boxes: list[tuple[str, Sequence[float], float, Vector, Quaternion]] = []
    plane: dict[str, Any] = {}
    if scene.grip:
        reach, height = scene.finger
        boxes.append(("fixed", FINGER, FINGER_MASS, (-reach, 0.0, height), LEVEL))
        boxes.append(("pressed", FINGER, FINGER_MASS, (reach, 0.0, height), LEVEL))
    elif scene.belt:
        boxes.append(("driven", BELT, 1.0, (0.0, 0.0, -BELT[2]), LEVEL))
    else:
        plane = {"normal": scene.normal}
    for mass, side, place in scene.stack:
        boxes.append(("free", [side / 2] * 3, mass, place, scene.orientation))
    columns = zip(("kind", "half", "mass", "place", "orientation"), zip(*boxes, strict=True), strict=True)
    acting = {"friction": scene.friction, "belt": scene.belt, "grip": scene.grip, "gravity": GRAVITY}
    return {**dict(columns), **acting, **plane}
