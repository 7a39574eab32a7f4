"""The friction oscillator in the exact solver: free decay, and when it begins to stop."""

from itertools import pairwise

import numpy as np
import pytest

from reference_lcp import Chain, HarmonicForce, Mode, StillBase, simulate, steady_state
from reference_lcp.exact.continuous_sliding import largest_sliding_friction
from tests.reference_lcp.cases import STANDING, one_cell
from tests.reference_lcp.exact.one_contact_systems import oscillator as one_mass


def test_free_decay_loses_four_bounds_over_stiffness_a_cycle_and_rests_in_the_dead_band() -> None:
    """Coulomb friction lowers the amplitude by 4 F / k a cycle, until |x| <= F / k at a turn."""
    friction, stiffness, start = 2.0, 100.0, 0.27
    chain = one_cell(friction, outer_mass=STANDING, inner_stiffness=stiffness)
    period = 2 * np.pi / np.sqrt(stiffness)
    run = simulate(chain, StillBase(), time_step=period / 8, steps=40, positions=np.array([0.0, start]), solver="exact")
    turns = run.inner_positions[3::4, 0]
    expected = start - 2 * friction / stiffness * np.arange(1, 7)
    assert turns[:6] * (-1.0) ** np.arange(1, 7) == pytest.approx(expected, abs=1e-10)
    assert np.ptp(run.inner_positions[-8:, 0]) < 1e-12
    assert abs(turns[-1]) <= friction / stiffness


def oscillator(force_ratio: float) -> Chain:
    """An outer mass that slides on an inner one that stands still: k = 100 N/m, and friction over a force of 10 N."""
    return one_cell(10.0 * force_ratio, inner_mass=STANDING, chain_stiffness=60.0, inner_stiffness=40.0)


def modes_over_a_period(frequency_ratio, force_ratio, **how) -> list[Mode]:
    """Modes that a friction oscillator driven by P0 sin ωt runs through in its steady state."""
    drive = HarmonicForce(10.0, frequency_ratio * 10.0)
    steady = steady_state(oscillator(force_ratio), drive, with_error_bar=False, **how)
    return [change.kind for change in steady.transitions]


@pytest.mark.parametrize("frequency_ratio", [0.45, 0.6, 0.8, 1.3])
def test_oscillator_begins_to_stop_twice_a_cycle_at_den_hartogs_limit(frequency_ratio) -> None:
    limit = largest_sliding_friction(one_mass(frequency_ratio))
    assert modes_over_a_period(frequency_ratio, 0.99 * limit, solver="exact").count(Mode.STICK) == 0
    assert modes_over_a_period(frequency_ratio, 1.01 * limit, solver="exact").count(Mode.STICK) == 2


@pytest.mark.parametrize(
    ("frequency_ratio", "force_ratio", "stops", "turns"),
    [(0.8, 0.5, 0, 2), (0.8, 0.95, 2, 0), (0.35, 0.03, 0, 2), (0.35, 0.1, 2, 2), (0.3, 0.1, 4, 0), (0.2, 0.4, 4, 0)],
)
def test_stops_of_the_oscillator_come_in_pairs_and_more_of_them_at_low_frequency(
    frequency_ratio, force_ratio, stops, turns
) -> None:
    """Hong and Liu 2001: 0, 2, 4, … stops a cycle; the scheme at a fine step counts the same.

    At (0.35, 0.1) the mass stops and goes on in the same direction, and turns without stopping.
    """
    for how in ({"solver": "exact"}, {"steps_per_period": 25_600}):
        modes = modes_over_a_period(frequency_ratio, force_ratio, **how)
        cyclic = [*modes, modes[0]]
        assert modes.count(Mode.STICK) == stops
        assert sum(Mode.STICK not in pair for pair in pairwise(cyclic)) == turns
