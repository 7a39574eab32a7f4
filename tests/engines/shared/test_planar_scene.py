"""Motions in a plane, as scenes in space read them."""

import math

import numpy as np
import pytest

from multibody_xval.engines.shared.planar_scene import turned


@pytest.mark.parametrize("angle", [-0.3, 0.0, 1.2])
def test_a_turn_in_the_plane_leads_x_to_z(angle) -> None:
    w, x, y, z = turned(angle)
    assert (x, z) == (0.0, 0.0)
    ahead = np.array([1 - 2 * y * y, 0.0, -2 * w * y])  # of (1, 0, 0)
    assert ahead == pytest.approx([math.cos(angle), 0.0, math.sin(angle)])
