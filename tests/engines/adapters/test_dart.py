"""DART: what only its friction, its springs and its readings do."""

import numpy as np
import pytest

from multibody_xval.engines.dart import Dart
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.errors import ParameterError
from tests.engines.scheme_oracle import STEPS, built_with, lane_of, scheme, with_coefficients

pytestmark = pytest.mark.needs("dart")


def run(lane: Lane, state: State, steps: int, **options: object) -> Trajectory:
    return built_with(Dart(), lane, **options).run(state, 0, steps)[0]


def test_a_stuck_contact_keeps_the_softness_of_what_friction_takes_from_it() -> None:
    lane, mixing = lane_of(5.0, 0.3), Dart().preset("joint", "tuned")["constraint force mixing"]
    motion = run(lane, State.at_rest(1, 7), STEPS)
    taken = motion.friction * lane.time_step * (1 / lane.chain.outer_mass + 1 / lane.chain.inner_mass)
    left = -motion.relative_velocity / np.max(np.abs(taken), axis=0)
    expected = mixing * taken / np.max(np.abs(taken), axis=0)
    np.testing.assert_allclose(left, expected, rtol=0, atol=1e-5 * mixing)


def test_slow_chains_do_not_fall_asleep() -> None:
    """All bodies stay below DART's threshold of 0.01 m/s for more than its half second."""
    chain = Chain.from_ratios(friction_ratio=0.3, base_amplitude=1e-5)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9, 1e-5), STEPS)
    motion = run(lane, State.at_rest(1, 7), 8 * STEPS, units="SI")
    assert np.max(np.abs(motion.velocities)) < 0.01
    assert motion.time[-1] > 1
    np.testing.assert_allclose(motion.positions, scheme(lane, State.at_rest(1, 7), 8 * STEPS)[0], atol=1e-8 * 1e-5)


def test_four_points_of_contact_are_four_times_as_hard_as_one() -> None:
    """In the first step a contact keeps DART's constraint force mixing, a part of what presses it."""
    lane = lane_of(0.3, 0.6)
    errors = [
        1
        - Dart().build([lane], "contact", preset).run(State.at_rest(1, 7), 0, 1)[0].normal_force
        / lane.chain.normal_force
        for preset in ("tuned", "sphere")
    ]
    # The drive has reached the first cell only.
    np.testing.assert_allclose(errors[0][0, 1:], 1e-5 / 4, rtol=1e-3)
    np.testing.assert_allclose(errors[1][0, 1:], 1e-5, rtol=1e-3)


def test_a_box_that_starts_deeper_is_pushed_harder(monkeypatch: pytest.MonkeyPatch) -> None:
    """DART pushes out a hundredth of a depth in every step, which is a force beside the one that is given."""
    lane = lane_of(0.3, 0.6)
    monkeypatch.setattr("multibody_xval.engines.dart.contact.DEPTH", 1e-3)
    motion = Dart().build([lane], "contact").run(State.at_rest(1, 7), 0, 10)[0]
    assert np.max(motion.normal_force / lane.chain.normal_force) > 1.001


def test_coefficients_that_dart_takes_for_zero_are_refused() -> None:
    with pytest.raises(ParameterError, match=r"friction_coefficient = 0.001 is frictionless for DART"):
        Dart().build([with_coefficients(0.001)], "contact")
