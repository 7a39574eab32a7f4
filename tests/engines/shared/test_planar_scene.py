"""Motions in a plane, as scenes in space read them."""

import math

import numpy as np
import pytest

from multibody_xval.engines.shared.planar_scene import row


@pytest.mark.parametrize("angle", [-0.3, 0.0, 1.2])
def test_a_turn_in_the_plane_leads_x_to_z(angle) -> None:
    place, (w, x, y, z), velocity = row((1.0, 2.0), angle, (3.0, 4.0))
    assert (place, velocity) == ((1.0, 0.0, 2.0), (3.0, 0.0, 4.0))
    assert (x, z) == (0.0, 0.0)
    turned = np.array([1 - 2 * y * y, 0.0, -2 * w * y])  # of (1, 0, 0)
    assert turned == pytest.approx([math.cos(angle), 0.0, math.sin(angle)])
