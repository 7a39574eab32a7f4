"""MuJoCo Warp: how its friction presses; more in `test_own_values.py`."""

import numpy as np
import pytest

from tests.engines.scheme_oracle import lane_of, random_state, run


@pytest.mark.needs("mujoco-warp")
def test_friction_raises_the_normal_force_by_the_square_of_the_coefficient() -> None:
    """Of a slip a hundred times as fast as the chain's; the preset's small coefficient makes it vanish otherwise."""
    lane, state = lane_of(), random_state(size=100.0)
    excess = [
        np.max(run("mujoco-warp:contact", lane, state, 50, coefficient=own).normal_force / lane.chain.normal_force - 1)
        for own in (0.1, 0.01)
    ]
    assert excess[0] > 0.01
    assert excess[0] == pytest.approx(100 * excess[1], rel=0.05)
