"""Pinocchio: what only its constraint, its solvers and their tolerances do."""

import numpy as np
import pytest

from multibody_xval.engines.pinocchio import Pinocchio
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from tests.engines.scheme_oracle import AMPLITUDE, STEPS, built_with, lane_of, random_state, scheme, uneven_lane

pytestmark = pytest.mark.needs("pinocchio")


def run(lane: Lane, state: State, preset: str, steps: int = STEPS, **options: object) -> Trajectory:
    return built_with(Pinocchio(), lane, "joint", preset, **options).run(state, 0, steps)[0]


def scaled_lane(length: float) -> Lane:
    """Base and friction are that small, and the rest is the canonical chain."""
    chain = Chain.from_ratios(friction_ratio=0.3, base_amplitude=length)
    return Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9, length), STEPS)


def test_sliding_friction_is_the_bound_as_a_force() -> None:
    """A friction constraint takes its bounds for forces over one second, until it is told the time step."""
    lane, state = uneven_lane(), random_state()
    motion = run(lane, state, "tuned")
    bound = lane.chain.friction_bound
    sliding = np.abs(motion.relative_velocity) > AMPLITUDE
    expected = np.broadcast_to(bound, sliding.shape)[sliding]
    assert np.count_nonzero(sliding) > STEPS
    np.testing.assert_allclose(np.abs(motion.friction[sliding]), expected, rtol=1e-12)


@pytest.mark.parametrize("preset", ["tuned", "default"])
def test_gauss_seidel_is_exact_however_small_the_impulses_are(preset: str) -> None:
    lane, state = scaled_lane(1e-9), State.at_rest(1, 7)
    motion = run(lane, state, preset, 2 * STEPS)
    np.testing.assert_allclose(motion.positions, scheme(lane, state, 2 * STEPS)[0], rtol=0, atol=1e-21)


def test_admm_gives_no_friction_to_impulses_below_its_absolute_tolerance() -> None:
    """Its own tolerance of 1e-6 holds in newton seconds and metres a second alike."""
    lane, state = scaled_lane(1e-9), State.at_rest(1, 7)
    motion = run(lane, state, "admm", 2 * STEPS)
    frictionless = scheme(lane_of(0.0, 0.9), state, 2 * STEPS)[0] * (1e-9 / AMPLITUDE)
    np.testing.assert_allclose(motion.positions, frictionless, rtol=0, atol=1e-12)


def test_admm_with_a_finer_tolerance_comes_nearer_to_the_scheme() -> None:
    lane, state = lane_of(0.3, 0.9), State.at_rest(1, 7)
    expected = scheme(lane, state, 2 * STEPS)[0]
    coarse, fine = (
        np.max(np.abs(run(lane, state, "admm", 2 * STEPS, tolerance=tolerance).positions - expected))
        for tolerance in (1e-6, 1e-10)
    )
    assert fine < 1e-3 * coarse < 1e-6 * AMPLITUDE
