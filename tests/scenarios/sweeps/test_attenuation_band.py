"""The attenuation band: which interval counts, and where its edges are."""

import numpy as np
import pytest
from scipy.optimize import brentq

from multibody_xval.scenarios.sweeps.attenuation_band import (
    EDGE_RESOLUTION,
    BandDefinition,
    Edge,
    edge_brackets,
    refined_crossings,
    unresolved,
)
from reference_lcp import Chain, HarmonicBase, ParameterError, decibel, frictionless_transmittance

ETA = np.arange(0.0, 1.01, 0.1)
BAND = BandDefinition()


def test_ripple_that_is_not_deep_does_not_count() -> None:
    curve = np.array([5, -3, 4, -9, 2, -4, -20, -30, -5, 1, -40.0])
    brackets = edge_brackets(ETA, curve, BAND)
    assert brackets[Edge.LOWER] == pytest.approx((0.4, 0.5))
    assert brackets[Edge.UPPER] == pytest.approx((0.8, 0.9))


def test_band_that_never_ends_has_a_lower_edge_only() -> None:
    assert set(edge_brackets(ETA, np.linspace(5, -50, 11), BAND)) == {Edge.LOWER}


def test_curve_without_deep_attenuation_has_no_band() -> None:
    assert edge_brackets(ETA, np.full(11, -9.0), BAND) == {}


def test_points_without_a_steady_state_are_passed_over() -> None:
    curve = np.array([5, 4, np.nan, -5, -20, np.nan, -20, -20, 3, 4, 4.0])
    brackets = edge_brackets(ETA, curve, BAND)
    assert brackets[Edge.LOWER] == pytest.approx((0.1, 0.3))
    assert brackets[Edge.UPPER] == pytest.approx((0.7, 0.8))


def test_threshold_and_depth_are_parameters() -> None:
    curve = np.array([5, -3, 4, -9, 2, -4, -20, -30, -5, 1, -40.0])
    brackets = edge_brackets(ETA, curve, BandDefinition(threshold_db=-3.5, depth_db=-8))
    assert brackets[Edge.LOWER] == pytest.approx((0.2, 0.3))
    with pytest.raises(ParameterError, match="depth_db = 1; allowed: below threshold_db = 0"):
        BandDefinition(depth_db=1.0)


def test_edges_are_refined_to_the_resolution_in_all_curves_at_once() -> None:
    shifts = np.array([0.11, 0.2345, 0.3])

    def curves(index, eta):
        return np.tanh(30 * (shifts[index] - eta)) + 0.2 * (shifts[index] - eta)

    crossings = refined_crossings([(0.0, 0.3), (0.2, 0.9), (0.25, 0.45)], curves, BAND)
    assert [crossing.frequency_ratio for crossing in crossings] == pytest.approx(shifts, abs=EDGE_RESOLUTION)
    assert [crossing.slope for crossing in crossings[:2]] == pytest.approx([-30.2] * 2, rel=1e-3)
    assert all(0 < crossing.width <= EDGE_RESOLUTION for crossing in crossings[:2])
    # the search has met the third one exactly
    assert crossings[2].width == 0


def test_refinement_that_meets_a_point_without_an_answer_gives_nan() -> None:
    def curve(index, eta):
        return np.where(np.abs(eta - 0.5) < 0.4, np.nan, 1 - 2 * eta)

    assert [np.isnan(crossing.frequency_ratio) for crossing in refined_crossings([(0.0, 1.0)], curve, BAND)] == [True]


def test_crossing_hidden_between_points_close_below_the_threshold_is_looked_for() -> None:
    eta = np.array([0.5, 0.9, 0.95, 1.0, 1.1, 1.2])
    curve = np.array([3.0, 0.5, -0.5, -1.0, -8.0, -20.0])
    assert unresolved(eta, curve, BAND) == pytest.approx([0.925, 0.975, 1.05])
    fine = np.arange(0.9, 1.3, 0.01)
    assert unresolved(fine, np.linspace(0.5, -20, fine.size), BAND).size == 0


def test_frictionless_edges_of_the_finite_chain_are_roots_of_its_linear_response() -> None:
    """The canonical chain: 0.8526 and √2, the upper one Bloch's band edge of the infinite chain."""
    chain = Chain.from_ratios()

    def exact(eta):
        return decibel(frictionless_transmittance(chain, HarmonicBase.from_ratio(chain, eta)))

    eta = np.arange(0.1, 3.0, 0.005)
    brackets = edge_brackets(eta, np.array([exact(ratio) for ratio in eta]), BAND)
    assert brentq(exact, *brackets[Edge.LOWER]) == pytest.approx(0.8526, abs=5e-5)
    assert brentq(exact, *brackets[Edge.UPPER]) == pytest.approx(np.sqrt(2), abs=5e-4)
