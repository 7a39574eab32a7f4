"""Joints cell by cell: outer mass, inner mass relative to it, and others that stay at zero."""

import numpy as np

from reference_lcp.validation import FloatArray


def joint_coordinates(absolute: FloatArray, joints: int) -> FloatArray:
    """Turn (u, v), shape (..., 2n), into (u_1, v_1 - u_1, ..., u_2, ...), `joints` a cell; velocities likewise."""
    outer, inner = np.split(absolute, 2, axis=-1)
    coordinates = np.zeros((*outer.shape, joints))
    coordinates[..., 0], coordinates[..., 1] = outer, inner - outer
    return coordinates.reshape(*outer.shape[:-1], -1)


def absolute_coordinates(coordinates: FloatArray, joints: int) -> FloatArray:
    """Turn (u_1, v_1 - u_1, ..., u_2, ...), `joints` a cell, into (u, v); velocities likewise."""
    outer, relative = coordinates[..., 0::joints], coordinates[..., 1::joints]
    return np.concatenate([outer, outer + relative], axis=-1)
