"""Harmonic balance: exact in the linear limits, near the exact motion in between, and what it saves the search."""

import numpy as np
import pytest

from reference_lcp import Chain, HarmonicBase, HarmonicForce
from reference_lcp.chain.linear_response import frictionless_response, stuck_response
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.schemes.euler import CompiledSimulation
from reference_lcp.steady.harmonic_balance import LEAST_SLIP, LOSS_FACTOR, harmonic_balance_start
from reference_lcp.steady.orbits import periodic_orbits
from tests.reference_lcp.cases import canonical_lane

STEPS = 400


def start(chain, drive, steps=STEPS):
    """Non-dimensional positions and velocities at phase zero."""
    state = harmonic_balance_start([Lane.periodic(chain, drive, steps)], steps)
    scale = drive.displacement_scale(chain)
    return state.positions[0] / scale, state.velocities[0] / (scale * drive.angular_frequency)


@pytest.mark.parametrize("make", [HarmonicBase, HarmonicForce])
@pytest.mark.parametrize(
    ("friction", "response", "tolerance"),
    [(0.0, frictionless_response, 0.0), (1e4, stuck_response, 10 * LEAST_SLIP)],
    ids=["free", "stuck but for the least slip"],
)
def test_without_slip_or_friction_it_is_the_steady_state_of_the_scheme(friction, response, tolerance, make) -> None:
    """A plain period changes it by round-off. It tends to the linear response: ten times the steps leave a tenth."""
    chain = Chain.from_ratios(friction_ratio=friction)
    drive = make(0.01 if make is HarmonicBase else 30.0, 0.7 * chain.resonator_frequency)
    lane = Lane.periodic(chain, drive, STEPS)
    begin = harmonic_balance_start([lane], STEPS)
    (orbit,) = periodic_orbits(CompiledSimulation([lane]), STEPS, start=begin, max_periods=1)
    positions, velocities = start(chain, drive)
    assert orbit.residual <= tolerance + STEPS * 2.0**-52 * np.max(np.abs([positions, velocities]))
    expected = response(chain, drive) / drive.displacement_scale(chain)
    distances = []
    for steps in (STEPS, 10 * STEPS):
        positions, velocities = start(chain, drive, steps)
        distances.append(np.max(np.abs(velocities + 1j * positions - expected)) / np.max(np.abs(expected)))
    assert distances[0] < 2 * np.pi / STEPS
    assert distances[1] == pytest.approx(distances[0] / 10, rel=0.2)


@pytest.mark.parametrize("damping", [0.05, 0.02, 0.005, 0.001])
def test_a_linear_chain_is_found_in_one_period_where_its_outer_masses_weigh_nothing(damping: float) -> None:
    """At η_r = √(1 + mass ratio), where the search from the exact response once stood still, and close to it."""
    chain = Chain.from_ratios(cells=5, mass_ratio=0.5, stiffness_ratio=1.4, damping_ratio=damping, friction_ratio=0.0)
    ratios = (1.2, 1.2246, np.sqrt(1.5), 1.25)
    lanes = [Lane.periodic(chain, HarmonicBase.from_ratio(chain, ratio), STEPS) for ratio in ratios]
    orbits = periodic_orbits(CompiledSimulation(lanes), STEPS)
    assert all(orbit.converged and orbit.periods == 2 for orbit in orbits)


@pytest.mark.parametrize("friction", [1e-6, 1e-3, 0.01, 0.1])
def test_a_krylov_method_is_given_as_many_periods_as_the_state_has_dimensions(friction: float) -> None:
    """Five cells have twenty, and six plain periods come first: a restart after 25 came just before the end."""
    chain = Chain.from_ratios(
        cells=5, mass_ratio=0.5, stiffness_ratio=1.4, damping_ratio=0.001, friction_ratio=friction
    )
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 1.2246), STEPS)
    (orbit,) = periodic_orbits(CompiledSimulation([lane]), STEPS)
    assert orbit.converged
    assert orbit.periods < 60


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
