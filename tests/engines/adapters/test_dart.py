"""DART: what only its friction, its springs and its readings do."""

import numpy as np
import pytest

from multibody_xval.engines.interface.variant import Variant
from reference_lcp.chain.trajectory import State
from tests.engines.scheme_oracle import lane_of, run

pytestmark = pytest.mark.needs("dart")

REST = State.at_rest(1, 7)


def test_a_stuck_contact_keeps_the_softness_of_what_friction_takes_from_it() -> None:
    lane, mixing = lane_of(5.0, 0.3), Variant.parse("dart").preset["constraint force mixing"]
    motion = run("dart", lane, REST)
    taken = motion.friction * lane.time_step * (1 / lane.chain.outer_mass + 1 / lane.chain.inner_mass)
    most = np.max(np.abs(taken), axis=0)
    np.testing.assert_allclose(-motion.relative_velocity / most, mixing * taken / most, rtol=0, atol=1e-5 * mixing)


@pytest.mark.parametrize(("preset", "points"), [("tuned", 4), ("sphere", 1)])
def test_four_points_of_contact_are_four_times_as_hard_as_one(preset: str, points: int) -> None:
    """In the first step a contact keeps DART's constraint force mixing, a part of what presses it."""
    lane = lane_of(0.3, 0.6)
    missing = 1 - run(f"dart:contact:{preset}", lane, REST, 1).normal_force / lane.chain.normal_force
    np.testing.assert_allclose(missing[0, 1:], 1e-5 / points, rtol=1e-3)  # the drive has reached the first cell only


def test_a_box_that_starts_deeper_is_pushed_harder(monkeypatch: pytest.MonkeyPatch) -> None:
    """DART pushes out a hundredth of a depth in every step, which is a force beside the one that is given."""
    monkeypatch.setattr("multibody_xval.engines.dart.contact.DEPTH", 1e-3)
    lane = lane_of(0.3, 0.6)
    assert np.max(run("dart:contact", lane, REST, 10).normal_force / lane.chain.normal_force) > 1.001
