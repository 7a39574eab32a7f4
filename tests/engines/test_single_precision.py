"""Engines that compute in single precision: as near to the scheme as that can be, whatever the numbers of the chain."""

import numpy as np
import pytest

from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.tolerances import FRICTION_TOLERANCE, SINGLE
from multibody_xval.engines.interface.variant import Variant
from reference_lcp.chain.trajectory import State
from tests.engines.scheme_oracle import STEPS, built_with, lane_of, scheme
from tests.installed import each_variant


def each(*names: str) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("one", each_variant(map(Variant.parse, names)))


@each("box2d", "rapier", "rapier:contact", "sapien", "sapien:contact")
def test_friction_of_a_stuck_contact_is_what_it_takes_and_does_not_creep(one: Variant) -> None:
    lane = lane_of(5.0, 0.3)
    motion = one.build([lane]).run(State.at_rest(1, 7), 0, 3 * STEPS)[0]
    expected = scheme(lane, State.at_rest(1, 7), 3 * STEPS)[2]
    speed = np.max(np.abs(motion.velocities))
    drawn_back = 4 * STEPS if str(one) == "sapien:contact" else 4  # to where they began to stick
    assert np.max(np.abs(motion.relative_velocity)) <= drawn_back * SINGLE * speed
    assert np.max(np.abs(motion.friction - expected)) <= FRICTION_TOLERANCE["single"] * np.max(np.abs(expected))


@pytest.mark.parametrize(
    ("name", "damping", "soft"),
    [
        pytest.param("sapien", "drive damping", 1.0, marks=pytest.mark.needs("sapien")),
        pytest.param("newton", "target_kd", 10.0, marks=pytest.mark.needs("newton")),
    ],
)
def test_a_drive_that_is_not_hard_lets_stuck_contacts_creep(name: str, damping: str, soft: float) -> None:
    lane = lane_of(5.0, 0.3)
    hard, creeping = (
        built_with(engine(name), lane, **{damping: value}).run(State.at_rest(1, 7), 0, STEPS)[0]
        for value in (1e20, soft)
    )
    speed = np.max(np.abs(hard.velocities))
    assert np.max(np.abs(hard.relative_velocity)) <= 4 * SINGLE * speed
    assert np.max(np.abs(creeping.relative_velocity)) > 1e-4 * speed
