"""Cost and error of a point of figure 3 by several methods, harmonic balance among them."""

import time

import numpy as np
import pytest

from reference_lcp.chain.drives import HarmonicForce
from reference_lcp.chain.linear_response import frictionless_transmittance, stuck_transmittance
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.defaults import MINIMUM_STEPS_PER_PERIOD
from reference_lcp.studies import bench
from reference_lcp.studies.bench import (
    LCPS_OF_A_SAMPLE,
    _lemke,
    balanced_transmittance,
    bench_points,
    canonical_lane,
)
from truth import problem_named


@pytest.mark.parametrize("ratio", [0.5, 0.9, 1.4])
def test_harmonic_balance_without_friction_is_the_linear_response(ratio) -> None:
    lane = canonical_lane(0.0, ratio)
    expected = frictionless_transmittance(lane.chain, lane.drive)
    assert balanced_transmittance(lane, 400) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("ratio", [0.5, 0.6], ids=["anywhere", "beside a resonance without friction"])
def test_harmonic_balance_of_contacts_that_hardly_slip_is_the_response_of_stuck_ones(ratio) -> None:
    """The smoothed law creeps where Coulomb's sticks, by a part in ten thousand of the velocity scale."""
    chain = Chain.from_ratios(friction_ratio=100.0)
    lane = Lane.periodic(chain, HarmonicForce(1.0, ratio * chain.resonator_frequency), 400)
    assert balanced_transmittance(lane, 400) == pytest.approx(stuck_transmittance(chain, lane.drive), rel=1e-3)


def test_the_scheme_is_nearer_to_the_exact_point_than_harmonic_balance_and_its_bar_covers_it() -> None:
    scheme, barred, balance, exact = bench_points([(0.3, 0.5), (0.3, 0.9)])
    assert scheme["largest_error_db"] < 0.01
    assert scheme["largest_error_db"] < balance["largest_error_db"] < 0.5
    assert barred["covered"] == 1.0
    assert barred["median_bar_db"] >= barred["median_error_db"] == scheme["median_error_db"]
    assert [row["failed"] for row in (scheme, barred, balance, exact)] == [0, 0, 0, 0]
    assert all(np.isfinite(row["seconds_per_point"]) and row["seconds_per_point"] > 0 for row in (scheme, balance))


def test_steps_and_problems_of_lemkes_method_take_a_part_of_the_time_in_which_they_are_measured() -> None:
    begin = time.perf_counter()
    step, problem = _lemke()
    elapsed = time.perf_counter() - begin
    assert 0 < step * MINIMUM_STEPS_PER_PERIOD <= elapsed
    assert 0 < problem * LCPS_OF_A_SAMPLE <= elapsed


@pytest.mark.parametrize(("friction", "frequency"), [(0.1, 0.6), (0.3, 0.9), (0.6, 0.7), (1.0, 1.2)])
def test_nine_harmonics_are_within_a_tenth_of_a_decibel_of_the_proven_transmittance(friction, frequency) -> None:
    proven = float(problem_named(f"chain-steady-{friction:g}-{frequency:g}").observables["transmittance"].value)
    balanced = 20 * np.log10(balanced_transmittance(canonical_lane(friction, frequency), 400))
    assert balanced == pytest.approx(proven, abs=0.1)


def test_the_speed_of_lanes_counts_every_step_of_every_cell(monkeypatch) -> None:
    monkeypatch.setattr(bench, "_best", lambda _work: 2.0)
    steps = bench.BENCH_LANES * 7 * MINIMUM_STEPS_PER_PERIOD * bench.PERIODS_OF_A_SAMPLE
    assert bench._cell_steps_per_second() == steps / 2
