"""MuJoCo Warp: what only its graph, its worlds, its single precision and its solver do."""

import numpy as np
import pytest

from multibody_xval.engines.mujoco_warp import MuJoCoWarp
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from tests.engines.scheme_oracle import (
    AMPLITUDE,
    ROUNDINGS,
    STEPS,
    built_with,
    distance,
    lane_of,
    random_state,
    uneven_lane,
)

pytestmark = pytest.mark.needs("mujoco-warp")


def run(lane: Lane, state: State, steps: int = STEPS, formulation: str = "joint", **options: object) -> Trajectory:
    return built_with(MuJoCoWarp(), lane, formulation, **options).run(state, 0, steps)[0]


def test_a_solver_that_ends_before_it_has_converged_is_off_without_a_word(capfd: pytest.CaptureFixture[str]) -> None:
    """MuJoCo Warp would print it, on standard output; three iterations do not find which contacts stick, five do."""
    lane, state = uneven_lane(), random_state()
    alone = {"units": "SI", "noslip_iterations": 0}
    many, five, three = (run(lane, state, iterations=count, **alone).positions for count in (100, 5, 3))
    assert np.max(np.abs(five - many)) < ROUNDINGS * AMPLITUDE
    assert np.max(np.abs(three - many)) > 0.01 * AMPLITUDE
    assert capfd.readouterr() == ("", "")


def test_the_sweep_without_softness_makes_up_for_a_solver_that_has_not_converged() -> None:
    lane, state = uneven_lane(), random_state()
    assert distance(lane, state, run(lane, state, units="SI", iterations=1, noslip_iterations=0)) > 0.01
    assert distance(lane, state, run(lane, state, units="SI", iterations=1, noslip_iterations=1)) < ROUNDINGS


def test_in_units_of_the_lane_the_solver_takes_anything_for_converged() -> None:
    """Its tolerance of 1e-6 is in the units of the model; in these, accelerations of the chain are smaller."""
    lane, state = uneven_lane(), random_state()
    one, hundred = (run(lane, state, iterations=count, noslip_iterations=0).positions for count in (1, 100))
    assert np.array_equal(one, hundred)
    assert distance(lane, state, run(lane, state, iterations=100, noslip_iterations=0)) > 0.01


def test_friction_raises_the_normal_force_by_the_square_of_the_coefficient() -> None:
    """Of a slip a hundred times as fast as the chain's; the preset's small coefficient makes it vanish otherwise."""
    lane, state = lane_of(), random_state(size=100.0)
    excess = [
        np.max(run(lane, state, 50, "contact", coefficient=coefficient).normal_force / lane.chain.normal_force - 1)
        for coefficient in (0.1, 0.01)
    ]
    assert excess[0] > 0.01
    assert excess[0] == pytest.approx(100 * excess[1], rel=0.05)
