"""The friction oscillator in the exact solver: free decay, Den Hartog's sliding motion, stops."""

import cmath
from itertools import pairwise

import numpy as np
import pytest

from reference_lcp import Chain, HarmonicForce, Mode, ParameterError, StillBase, simulate, steady_state
from reference_lcp.exact.den_hartog import SlidingMotion, largest_sliding_force_ratio
from tests.reference_lcp.cases import STANDING, one_cell


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


@pytest.mark.parametrize(("frequency_ratio", "force_ratio"), [(0.8, 0.3), (1.3, 0.4), (0.6, 0.2), (0.35, 0.03)])
def test_sliding_friction_oscillator_moves_as_den_hartog_found(frequency_ratio, force_ratio) -> None:
    """It turns at x0 in Den Hartog's phase, slides all the way to −x0, and has his first harmonic."""
    drive, sliding = HarmonicForce(10.0, frequency_ratio * 10.0), SlidingMotion.of(frequency_ratio, force_ratio)
    steady = steady_state(oscillator(force_ratio), drive, solver="exact")
    turns = sorted((sliding.turn + part) % 1 for part in (0, 0.5))
    assert [change.time / drive.period for change in steady.transitions] == pytest.approx(turns, abs=1e-10)
    assert Mode.STICK not in [change.kind for change in steady.transitions]
    assert steady.travels == pytest.approx([2 * sliding.amplitude * 0.1] * 2, abs=1e-10)
    # displacements are over P0 / k_c here and over P0 / (k_c + k_i) in Den Hartog's formula
    found = cmath.rect(10 ** (steady.transmittance_db / 20), steady.phase)
    assert found == pytest.approx(0.6 * sliding.response, rel=1e-9)


def modes_over_a_period(frequency_ratio, force_ratio, **how) -> list[Mode]:
    """Modes that a friction oscillator driven by P0 sin ωt runs through in its steady state."""
    drive = HarmonicForce(10.0, frequency_ratio * 10.0)
    steady = steady_state(oscillator(force_ratio), drive, with_error_bar=False, **how)
    return [change.kind for change in steady.transitions]


@pytest.mark.parametrize("frequency_ratio", [0.45, 0.6, 0.8, 1.3])
def test_oscillator_begins_to_stop_twice_a_cycle_at_den_hartogs_limit(frequency_ratio) -> None:
    limit = largest_sliding_force_ratio(frequency_ratio)
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


@pytest.mark.parametrize(
    ("frequency_ratio", "force_ratio"), [(1.0, 0.1), (0.5, 0.1), (0.8, 0.99), (0.8, -0.1), (-1, 0.1)]
)
def test_motion_that_den_hartog_does_not_describe_is_refused(frequency_ratio, force_ratio) -> None:
    with pytest.raises(ParameterError, match="allowed"):
        SlidingMotion.of(frequency_ratio, force_ratio)
