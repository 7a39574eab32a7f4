"""What dies out ends at zero: subnormal numbers are slow, and no motion of a chain; all others are as they were."""

import numpy as np
import pytest

from reference_lcp import Chain, CompiledSimulation, Lane, State, StillBase
from reference_lcp.schemes.subnormals import IS_X86

pytestmark = pytest.mark.skipif(not IS_X86, reason="the control register is set on x86-64 only")

SUBNORMAL = 1e-310
STEPS = 50


def lane(friction_ratio: float = 0.0) -> Lane:
    return Lane(Chain.from_ratios(cells=20, friction_ratio=friction_ratio), StillBase(), 1e-3)


def everywhere(size: float) -> State:
    rng = np.random.default_rng(1)
    return State(size * rng.standard_normal((1, 40)), size * rng.standard_normal((1, 40)))


def test_a_motion_below_the_normal_numbers_ends_at_zero() -> None:
    ended = CompiledSimulation([lane()]).advance(everywhere(SUBNORMAL), 0, STEPS)
    assert not np.any(ended.positions)
    assert not np.any(ended.velocities)
    assert np.all(np.array([SUBNORMAL]) * 0.75 > 0), "outside, subnormal numbers are what they were"


def test_a_linear_motion_is_the_same_to_the_last_bit_at_any_size_of_normal_numbers() -> None:
    power = 2.0**-900
    large, small = (CompiledSimulation([lane()]).advance(everywhere(size), 0, STEPS) for size in (1.0, power))
    assert np.array_equal(small.positions, power * large.positions)
    assert np.array_equal(small.velocities, power * large.velocities)
