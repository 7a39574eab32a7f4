"""Contacts of two bodies that are pressed on each other, in engines that have them."""

import numpy as np
import pytest

from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.tolerances import ROUND_OFF
from reference_lcp.chain.trajectory import State
from tests.engines.scheme_oracle import AMPLITUDE, STEPS, lane_of, random_state
from tests.installed import each_engine


@pytest.mark.parametrize("name", each_engine(["box2d", "dart", "ode", "pybullet", "pymunk", "rapier", "sapien"]))
def test_a_body_that_leaves_its_plate_is_reported(name: str) -> None:
    """Beyond the end of the plate it would feel no friction."""
    away = State(np.concatenate([np.zeros(7), np.full(7, 1e7 * AMPLITUDE)])[None], np.zeros((1, 14)))
    simulation = engine(name).build([lane_of(0.3)], "contact")
    with pytest.raises(RuntimeError, match=r"its plate ends at|left the plate"):
        simulation.advance(away, 0, 1)
    simulation.close()


@pytest.mark.parametrize("preset", ["tuned", "default"])
@pytest.mark.parametrize("name", each_engine(["box2d", "pymunk", "rapier"]))
def test_a_pressed_box_neither_bounces_nor_sinks_nor_is_pushed_out(name: str, preset: str) -> None:
    """Over a hundred periods every contact is there in every step, with the force that presses it."""
    lane = lane_of(0.3, 0.9)
    simulation = engine(name).build([lane], "contact", preset)
    state = simulation.advance(random_state(), 0, 100 * STEPS)
    motion = simulation.run(state, 0, STEPS)[0]
    given, precision = np.broadcast_to(lane.chain.normal_force, (STEPS, 7)), engine(name).capabilities.precision
    np.testing.assert_allclose(motion.normal_force, given, rtol=max(ROUND_OFF[precision], 1e-9))


AS_IT_COMES = (
    "mujoco", "mujoco-warp", "pybullet", "exudyn-regularised", "dart", "drake", "sapien", "rapier", "newton", "ode",
    "siconos", "genesis",
)  # fmt: skip
"""Engines whose default contact is one that a newcomer would build: nothing but a given force acts across the row."""

LANDING = 0.05
"""Part of a period that a hop may still be under way at its end, in which nothing presses: MuJoCo's spheres hop."""


@pytest.mark.parametrize("name", each_engine(AS_IT_COMES))
def test_friction_of_a_default_contact_takes_nothing_from_what_presses_it(name: str) -> None:
    """What presses a body is what carries it, however it slips: the mean is λ_N, by the balance of momentum across."""
    lane = lane_of(0.3, 0.6)
    motion = engine(name).build([lane], "contact", "default").run(random_state(), 0, STEPS)[0]
    mean = np.mean(motion.normal_force, axis=0) / lane.chain.normal_force
    assert mean == pytest.approx(np.ones(7), abs=LANDING)
