"""Scenes in the plane of x and z, for engines in two dimensions: what they can represent, and their rows."""

import math
from typing import Any

from engines.interface.scene import ContactScene, Vector
from reference_lcp.errors import ParameterError


def check_planar(scene: ContactScene) -> None:
    """Raise unless nothing of a scene leaves the plane."""
    if scene.turn:
        raise ParameterError(f"turn = {scene.turn:g} of a box on its plane; allowed in two dimensions: 0")


def in_plane(vector: Vector) -> tuple[float, float]:
    """Give a vector along x and z, or raise if it has a part along y."""
    x, y, z = vector
    if y:
        raise ParameterError(f"launch = {vector}; allowed in two dimensions: nothing along y")
    return x, z


def row(place: Any, angle: float, velocity: Any) -> tuple[Vector, tuple[float, ...], Vector]:
    """Give position, orientation and velocity in space; an angle counts from x to z, about −y."""
    turned = (math.cos(angle / 2), 0.0, -math.sin(angle / 2), 0.0)
    return (place[0], 0.0, place[1]), turned, (velocity[0], 0.0, velocity[1])
