"""PyBullet: what only its motors, its contacts and its limits do."""

import numpy as np
import pytest

from engines.pybullet import PyBullet
from reference_lcp.chain.harmonic import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.refusal import ParameterError
from tests.engines.scheme_oracle import (
    AMPLITUDE,
    STEPS,
    assert_equals_scheme,
    built_with,
    lane_of,
    random_state,
    with_coefficients,
)

pytestmark = pytest.mark.skipif(PyBullet().unavailable_reason() is not None, reason="pybullet is not installed")


both_formulations = pytest.mark.parametrize("formulation", ["joint", "contact"])


def run(lane: Lane, state: State, steps: int, formulation: str = "joint") -> Trajectory:
    return PyBullet().build([lane], formulation).run(state, 0, steps)[0]


def test_a_closed_simulation_reopens_its_world() -> None:
    """Closing a subset closes the world that it shares; the others must go on."""
    simulation = PyBullet().build([lane_of(), lane_of(1.0)])
    before = simulation.advance(random_state(2), 0, 10).positions
    simulation.subset([0]).close()
    assert np.array_equal(simulation.advance(random_state(2), 0, 10).positions, before)
    simulation.close()


def test_the_longest_chain_equals_the_scheme_and_a_longer_one_is_refused() -> None:
    chain = Chain.from_ratios(cells=63, friction_ratio=0.3)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.6, AMPLITUDE), STEPS)
    assert_equals_scheme(lane, State.at_rest(1, 63), run(lane, State.at_rest(1, 63), 100))
    longer = Chain.from_ratios(cells=64)
    with pytest.raises(ParameterError, match=r"cells = 64 .* at most 63"):
        PyBullet().build([Lane(longer, lane.drive, lane.time_step)])


def with_option(name: str, value: float) -> Trajectory:
    """A period from rest, in the joint, with one tuned option changed."""
    return built_with(PyBullet(), lane_of(), **{name: value}).run(State.at_rest(1, 7), 0, STEPS)[0]


def test_the_motor_that_a_joint_is_born_with_would_freeze_the_chain() -> None:
    assert np.max(np.abs(with_option("outer motor force", 1e6).positions)) < 1e-6 * AMPLITUDE
    assert np.max(np.abs(with_option("outer motor force", 0.0).positions)) > 0.5 * AMPLITUDE


def test_damping_of_bodies_in_the_units_of_the_lane_would_stop_the_chain() -> None:
    """It is a rate: 0.04 in a second is another one in a time step."""
    assert np.max(np.abs(with_option("linearDamping", 0.04).positions)) < 0.5 * AMPLITUDE


def test_a_weak_gain_of_a_motor_is_not_coulomb_friction() -> None:
    """With 0.1 a motor leaves nine tenths of the relative velocity."""
    simulation = built_with(PyBullet(), lane_of(5.0, 0.3), velocityGain=0.1)
    trajectory = simulation.run(State.at_rest(1, 7), 0, STEPS)[0]
    assert np.max(np.abs(trajectory.relative_velocity)) > 1e-6 * AMPLITUDE


def test_the_reason_for_a_missing_package_names_the_python_versions(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("engines.shared.wheel_engine.importlib.util.find_spec", lambda _: None)
    reason = PyBullet().unavailable_reason()
    assert reason is not None
    assert "CPython 3.11" in reason


def test_coefficients_that_bullet_would_cut_off_are_refused() -> None:
    with pytest.raises(ParameterError, match=r"friction_coefficient = 11; allowed by Bullet: at most 10"):
        PyBullet().build([with_coefficients(11.0)], "contact")


def test_a_box_that_leaves_its_plate_is_reported() -> None:
    lane = lane_of(0.0)
    state = State(np.concatenate([np.zeros(7), np.full(7, 1e7 * AMPLITUDE)])[None], np.zeros((1, 14)))
    with pytest.raises(RuntimeError, match="its plate ends at"):
        PyBullet().build([lane], "contact").advance(state, 0, 1)


@both_formulations
def test_default_damping_slows_every_mass_down(formulation: str) -> None:
    lane = lane_of(5.0)
    motion = PyBullet().build([lane], formulation, "default").run(State.at_rest(1, 7), 0, STEPS)[0]
    expected = run(lane, State.at_rest(1, 7), STEPS, formulation)
    assert np.linalg.norm(motion.velocities) < np.linalg.norm(expected.velocities)
    # stuck all the same: the motion of a contact is no worse than the solver
    assert np.max(np.abs(motion.relative_velocity)) < 1e-9 * AMPLITUDE * lane.drive.angular_frequency
