"""MuJoCo: what only its friction, its options and its limits do."""

import numpy as np
import pytest

from multibody_xval.engines.mujoco import MuJoCo
from reference_lcp.chain.drives import HarmonicBase, StillBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.errors import ParameterError
from tests.engines.scheme_oracle import (
    AMPLITUDE,
    STEPS,
    built_with,
    lane_of,
    random_state,
    scheme,
    unstable_lane,
    with_coefficients,
)

pytestmark = pytest.mark.needs("mujoco")


both_formulations = pytest.mark.parametrize("formulation", ["joint", "contact"])


def test_states_where_mujoco_would_stop_are_refused() -> None:
    simulation = MuJoCo().build([lane_of()])
    with pytest.raises(ParameterError, match=r"initial positions reach 1e\+12"):
        simulation.advance(State(np.full((1, 14), 1e12), np.zeros((1, 14))), 0, 1)


def test_forces_for_which_mujoco_would_take_none_are_refused() -> None:
    chain = Chain.from_ratios(chain_stiffness=1e12, outer_mass=1e9)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9, 1.0), STEPS)
    simulation = MuJoCo().build([lane], "joint", "default")
    with pytest.raises(ParameterError, match=r"^forces reach .* N; allowed by MuJoCo: 1e\+10 N"):
        simulation.advance(State.at_rest(1, 7), 0, STEPS)
    assert np.all(np.isfinite(MuJoCo().build([lane]).advance(State.at_rest(1, 7), 0, STEPS).positions))


def test_a_diverged_run_leaves_nothing_behind() -> None:
    simulation = MuJoCo().build([unstable_lane()])
    before = simulation.advance(State.at_rest(1, 7), 0, 3).positions
    simulation.advance(State.at_rest(1, 7), 0, 100)
    assert np.array_equal(simulation.advance(State.at_rest(1, 7), 0, 3).positions, before)


def test_without_the_no_slip_sweep_a_stuck_contact_creeps() -> None:
    """The option that removes MuJoCo's softness is needed: the law itself is regularised."""
    simulation = built_with(MuJoCo(), lane_of(5.0, 0.3), noslip_iterations=0)
    trajectory = simulation.run(State.at_rest(1, 7), 0, STEPS)[0]
    assert np.max(np.abs(trajectory.relative_velocity)) > 1e-6 * AMPLITUDE


@pytest.mark.parametrize("coefficient", [1e-5, [0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.004]])
def test_coefficients_that_mujoco_would_cut_off_or_take_for_singular_are_refused(coefficient: object) -> None:
    with pytest.raises(ParameterError, match=r"friction_coefficient = .* at least"):
        MuJoCo().build([with_coefficients(coefficient)], "contact")


def test_in_other_units_the_sweep_over_sliding_contacts_is_inexact() -> None:
    """MuJoCo solves for them to a fixed 1e-10: the units of the contact formulation are needed."""
    lane, state = with_coefficients(3.0), random_state()
    simulation = built_with(MuJoCo(), lane, "contact", units="lane")
    difference = simulation.run(state, 0, STEPS)[0].positions - scheme(lane, state, STEPS)[0]
    assert np.max(np.abs(difference)) > 1e-8 * AMPLITUDE


def test_a_weak_contact_that_turns_back_takes_no_more_than_its_bound() -> None:
    """MuJoCo compares forces with a fixed 1e-10: those of a bound far below the springs' must not be below it."""
    chain = Chain.from_ratios(
        cells=1, mass_ratio=1e-4, stiffness_ratio=2.5e-5, damping_ratio=0.0, friction_ratio=1.5e-6, base_amplitude=0.01
    )
    lane = Lane(chain, StillBase(0.01), 2 * np.pi / chain.resonator_frequency / STEPS)
    start = State(np.array([[0.0, 0.01]]), np.zeros((1, 2)))
    friction = MuJoCo().build([lane], "contact").run(start, 0, 4 * STEPS)[0].friction
    assert np.max(np.abs(friction)) == pytest.approx(chain.friction_bound[0], rel=1e-9)


@both_formulations
def test_a_default_contact_creeps_and_a_finer_step_does_not_help(formulation: str) -> None:
    """A time constant of its own, whatever the step: friction never stops a contact."""
    creep = []
    for steps in (STEPS, 4 * STEPS):
        coarse = lane_of(5.0)
        lane = Lane.periodic(coarse.chain, coarse.drive, steps)
        trajectory = MuJoCo().build([lane], formulation, "default").run(State.at_rest(1, 7), 0, 2 * steps)[0]
        creep.append(np.max(np.abs(trajectory.relative_velocity)) / (AMPLITUDE * lane.drive.angular_frequency))
    assert creep[0] > 0.01
    assert creep[1] == pytest.approx(creep[0], rel=0.1)


def test_a_default_joint_that_sticks_comes_to_rest_with_a_time_constant_of_10_6_ms() -> None:
    """Not the 20 ms of `solref`: of its rate 2 / (0.95 · 20 ms), the impedance of 0.9 acts in stick."""
    chain = Chain.from_ratios(cells=1, friction_ratio=5.0, chain_stiffness=1e-9, stiffness_ratio=1.0, damping_ratio=0.0)
    lane = Lane(chain, StillBase(AMPLITUDE), 1e-5)
    state = State(np.zeros((1, 2)), np.array([[0.0, 1e-12]]))
    slip = MuJoCo().build([lane], "joint", "default").run(state, 0, 1056)[0].relative_velocity[:, 0]
    assert slip[-1] == pytest.approx(1e-12 * np.exp(-1056 * 1e-5 * 0.9 * 2 / (0.95 * 0.02)), rel=1e-3)
    assert slip[-1] == pytest.approx(1e-12 / np.e, rel=2e-3)


def test_in_the_default_pyramid_friction_presses_the_contact() -> None:
    lane = lane_of(0.3, 0.9)
    trajectory = MuJoCo().build([lane], "contact", "default").run(State.at_rest(1, 7), 0, STEPS)[0]
    assert np.max(trajectory.normal_force / lane.chain.normal_force) > 1.5
