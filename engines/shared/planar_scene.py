"""Scenes in the plane of x and z, for engines in two dimensions: what they can represent, and their rows."""

import math
from collections.abc import Iterable
from itertools import pairwise

from multibody_xval.engines.interface.scene import ContactScene, Quaternion, Vector
from reference_lcp.errors import ParameterError


def check_planar(scene: ContactScene) -> None:
    """Raise unless nothing of a scene leaves the plane."""
    if scene.turn:
        raise ParameterError(f"turn = {scene.turn:g} of a box on its plane; allowed in two dimensions: 0")


def in_plane(vector: Vector, spin: float) -> tuple[float, float]:
    """Give a velocity along x and z, or raise if it leaves the plane."""
    x, y, z = vector
    if y or spin:
        raise ParameterError(f"launch = {vector}, {spin:g} rad/s; allowed in two dimensions: nothing out of the plane")
    return x, z


def hinge_angles(links: Iterable[float]) -> list[float]:
    """Give the angles of hinges in a row from those of the links that they carry."""
    return [after - before for before, after in pairwise([0.0, *links])]


def turned(angle: float) -> Quaternion:
    """Give the orientation in space of what is turned by an angle, which counts from x to z, about −y."""
    return math.cos(angle / 2), 0.0, -math.sin(angle / 2), 0.0
