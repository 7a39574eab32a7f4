"""Contacts of two bodies that are pressed on each other, in engines that have them."""

import numpy as np
import pytest

from engines.interface.registry import engine
from engines.interface.tolerances import ROUND_OFF
from reference_lcp.chain.trajectory import State
from tests.engines.scheme_oracle import AMPLITUDE, STEPS, lane_of, random_state

ENGINES = ("box2d", "dart", "ode", "pybullet", "pymunk", "rapier", "sapien")


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.needs(name)) for name in ENGINES])
def test_a_body_that_leaves_its_plate_is_reported(name: str) -> None:
    """Beyond the end of the plate it would feel no friction."""
    away = State(np.concatenate([np.zeros(7), np.full(7, 1e7 * AMPLITUDE)])[None], np.zeros((1, 14)))
    simulation = engine(name).build([lane_of(0.3)], "contact")
    with pytest.raises(RuntimeError, match=r"its plate ends at|left the plate"):
        simulation.advance(away, 0, 1)
    simulation.close()


@pytest.mark.parametrize("preset", ["tuned", "default"])
@pytest.mark.parametrize(
    ("name", "tolerance"),
    [
        pytest.param("box2d", ROUND_OFF["single"], marks=pytest.mark.needs("box2d")),
        pytest.param("pymunk", 1e-9, marks=pytest.mark.needs("pymunk")),
        pytest.param("rapier", ROUND_OFF["single"], marks=pytest.mark.needs("rapier")),
    ],
)
def test_a_pressed_box_neither_bounces_nor_sinks_nor_is_pushed_out(name: str, tolerance: float, preset: str) -> None:
    """Over a hundred periods every contact is there in every step, with the force that presses it."""
    lane = lane_of(0.3, 0.9)
    simulation = engine(name).build([lane], "contact", preset)
    state = simulation.advance(random_state(), 0, 100 * STEPS)
    motion = simulation.run(state, 0, STEPS)[0]
    given = np.broadcast_to(lane.chain.normal_force, (STEPS, 7))
    np.testing.assert_allclose(motion.normal_force, given, rtol=tolerance)
