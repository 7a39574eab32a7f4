"""Contacts of two bodies that are pressed on each other, in engines that have them."""

import numpy as np
import pytest

from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.tolerances import ROUND_OFF
from multibody_xval.engines.interface.variant import Variant
from reference_lcp.chain.trajectory import State
from reference_lcp.validation import FloatArray
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


def mean_normal_force(name: str) -> FloatArray:
    """Give λ_N of each cell over what presses it, a mean over a period from a random state."""
    lane, variant = lane_of(0.3, 0.6), Variant.parse(name)
    motion = variant.build([lane]).run(random_state(), 0, STEPS)[0]
    return np.mean(motion.normal_force, axis=0) / lane.chain.normal_force


AS_IT_COMES = (
    "mujoco",
    "mujoco-warp",
    "pybullet",
    "exudyn-regularised",
    "dart",
    "drake",
    "sapien",
    "rapier",
    "newton",
    "ode",
    "siconos",
    "genesis",
)
"""Engines whose default contact is one that a newcomer would build: nothing but a given force acts across the row."""

HOLDING = ("mujoco", "mujoco-warp", "genesis")
"""Those that can also hold a sphere in its plate."""

LANDING = 0.05
"""Part of a period that a hop may still be under way at its end, in which nothing presses: MuJoCo's spheres hop."""


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.needs(name)) for name in AS_IT_COMES])
def test_friction_of_a_default_contact_takes_nothing_from_what_presses_it(name: str) -> None:
    """What presses a body is what carries it, however it slips: the mean is λ_N, by the balance of momentum across."""
    assert mean_normal_force(f"{name}:contact:default") == pytest.approx(np.ones(7), abs=LANDING)


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.needs(name)) for name in HOLDING])
def test_sphere_that_is_held_in_its_plate_is_pressed_by_its_own_friction(name: str) -> None:
    """The construct of which the balance of momentum says nothing: here the mean is several times λ_N."""
    assert np.all(mean_normal_force(f"{name}:contact:default:across=held") > 2)
