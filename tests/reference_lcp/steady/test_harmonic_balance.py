"""Harmonic balance: exact in the linear limits, near the exact motion in between, and what it saves the search."""

import numpy as np
import pytest

from reference_lcp import Chain, HarmonicBase, HarmonicForce
from reference_lcp.chain.linear_response import frictionless_response, stuck_response
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.schemes.euler import CompiledSimulation
from reference_lcp.steady import harmonic_balance
from reference_lcp.steady.harmonic_balance import LEAST_SLIP, LOSS_FACTOR, harmonic_balance_start
from reference_lcp.steady.orbits import periodic_orbits
from tests.reference_lcp.cases import canonical_lane

STEPS = 400


def start(chain, drive):
    """Non-dimensional positions and velocities at phase zero."""
    state = harmonic_balance_start([Lane.periodic(chain, drive, STEPS)], STEPS)
    scale = drive.displacement_scale(chain)
    return state.positions[0] / scale, state.velocities[0] / (scale * drive.angular_frequency)


@pytest.mark.parametrize("make", [HarmonicBase, HarmonicForce])
@pytest.mark.parametrize(
    ("friction", "response", "tolerance"),
    [(0.0, frictionless_response, 1e-12), (1e4, stuck_response, 10 * LEAST_SLIP)],
    ids=["free", "stuck but for the least slip"],
)
def test_without_slip_or_friction_it_is_the_linear_response(friction, response, tolerance, make, monkeypatch) -> None:
    monkeypatch.setattr(harmonic_balance, "LOSS_FACTOR", 0.0)
    chain = Chain.from_ratios(friction_ratio=friction)
    drive = make(0.01 if make is HarmonicBase else 30.0, 0.7 * chain.resonator_frequency)
    positions, velocities = start(chain, drive)
    expected = response(chain, drive) / drive.displacement_scale(chain)
    assert np.allclose(velocities + 1j * positions, expected, rtol=0, atol=tolerance)


def test_undamped_resonance_is_finite() -> None:
    chain = Chain.from_ratios(cells=1, damping_ratio=0.0)
    resonance = np.sqrt((3 - np.sqrt(5)) / 2)
    positions, velocities = start(chain, HarmonicBase.from_ratio(chain, resonance))
    assert np.all(np.isfinite([positions, velocities]))
    assert np.max(np.abs([positions, velocities])) == pytest.approx(1 / LOSS_FACTOR, rel=0.5)


def test_resonance_that_takes_long_to_ring_up_is_found_in_half_the_periods() -> None:
    """Friction ratio 1 at the chain's lowest resonance: the motion grows to tens of the base's, and slides there."""
    simulation = CompiledSimulation([canonical_lane(1.0, 0.1478)])
    (from_rest,) = periodic_orbits(simulation, STEPS, start=State.at_rest(1, 7))
    (balanced,) = periodic_orbits(simulation, STEPS)
    assert balanced.converged
    assert from_rest.converged
    assert 2 * balanced.periods < from_rest.periods
