"""Scenes in the plane of x and z, for engines in two dimensions: what they can represent, and their rows."""

import math
from collections.abc import Iterable
from itertools import pairwise
from typing import Any

from multibody_xval.engines.interface.scene import ContactScene, Vector
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


def row(place: Any, angle: float, velocity: Any) -> tuple[Vector, tuple[float, ...], Vector]:
    """Give position, orientation and velocity in space; an angle counts from x to z, about −y."""
    turned = (math.cos(angle / 2), 0.0, -math.sin(angle / 2), 0.0)
    return (place[0], 0.0, place[1]), turned, (velocity[0], 0.0, velocity[1])
