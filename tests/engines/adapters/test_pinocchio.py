"""Pinocchio: what only its solvers and their tolerances do."""

import numpy as np
import pytest

from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from tests.engines.scheme_oracle import STEPS, chain_of, distance, lane_of, run, scheme

pytestmark = pytest.mark.needs("pinocchio")

REST = State.at_rest(1, 7)


def nanometres(friction_ratio: float) -> Lane:
    """The canonical chain, moved by a nanometre."""
    return chain_of(1.0, 1e3, 1e-9, friction_ratio)


@pytest.mark.parametrize("preset", ["tuned", "default"])
def test_gauss_seidel_is_exact_however_small_the_impulses_are(preset: str) -> None:
    assert distance(nanometres(0.3), REST, run(f"pinocchio:joint:{preset}", nanometres(0.3), REST, 2 * STEPS)) < 1e-12


def test_admm_gives_no_friction_to_impulses_below_its_absolute_tolerance() -> None:
    """Its own tolerance of 1e-6 holds in newton seconds and metres a second alike."""
    motion = run("pinocchio:joint:admm", nanometres(0.3), REST, 2 * STEPS)
    expected = scheme(nanometres(0.0), REST, 2 * STEPS)[0]
    np.testing.assert_allclose(motion.positions, expected, rtol=0, atol=1e-12)


def test_admm_with_a_finer_tolerance_comes_nearer_to_the_scheme() -> None:
    lane = lane_of(0.3, 0.9)
    coarse, fine = (
        distance(lane, REST, run("pinocchio:joint:admm", lane, REST, 2 * STEPS, tolerance=own)) for own in (1e-6, 1e-10)
    )
    assert fine < 1e-3 * coarse < 1e-6
