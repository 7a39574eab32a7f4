"""Points go where the curve bends: the frictionless chain, whose curve is known between the points too."""

import dataclasses
import math
from functools import cache

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from multibody_xval.scenarios.runs.parameters import ChainRatios
from multibody_xval.scenarios.sweeps import adaptive_grid
from multibody_xval.scenarios.sweeps.adaptive_grid import START_POINTS, AdaptiveAxis, AdaptiveCurve, level
from multibody_xval.scenarios.sweeps.refinement import resonances
from reference_lcp import HarmonicBase, ParameterError, decibel, frictionless_transmittance

AXIS = AdaptiveAxis(first=0.3, last=1.6, accuracy_db=0.5)
CLOSED_FORM_MULTIPLE = 1.5
"""Largest error between the points over the accuracy: 1.35 at 0.1 dB, less at 0.5 and 2 dB (ζ = 0.01 and 0.05)."""


chain_of = cache(lambda ratios: ratios.chain(0.0))


@cache
def closed_form(ratios: ChainRatios, eta: float) -> float:
    chain = chain_of(ratios)
    return decibel(frictionless_transmittance(chain, HarmonicBase.from_ratio(chain, eta)))


def curve_of(ratios: ChainRatios, axis: AdaptiveAxis) -> AdaptiveCurve:
    curve = AdaptiveCurve(axis, resonances(ratios).tolist())
    while curve.due:
        curve.add({eta: closed_form(ratios, eta) for eta in curve.due})
    return curve


def largest_error(ratios: ChainRatios, eta: np.ndarray, levels: np.ndarray, between: np.ndarray) -> float:
    truth = [level(closed_form(ratios, float(eta))) for eta in between]
    return float(np.max(np.abs(PchipInterpolator(eta, levels)(between) - truth)))


@pytest.mark.parametrize(("damping", "accuracy"), [(0.01, 0.1), (0.01, 0.5), (0.01, 2.0), (0.05, 0.5)])
def test_interpolated_curve_is_as_accurate_as_asked(damping: float, accuracy: float) -> None:
    ratios = ChainRatios(damping_ratio=damping)
    eta, levels = curve_of(ratios, dataclasses.replace(AXIS, accuracy_db=accuracy)).points
    between = np.concatenate([np.linspace(0.3, 1.6, 401), (eta[1:] + 3 * eta[:-1]) / 4, (3 * eta[1:] + eta[:-1]) / 4])
    assert largest_error(ratios, eta, levels, between) <= CLOSED_FORM_MULTIPLE * accuracy


def test_even_grid_of_five_times_the_points_is_less_accurate() -> None:
    ratios = ChainRatios()
    curve = curve_of(ratios, AXIS)
    eta, _ = curve.points
    assert curve.resolved
    assert eta.size < 250
    even = np.linspace(0.3, 1.6, 5 * eta.size)
    levels = np.array([level(closed_form(ratios, float(eta))) for eta in even])
    peaks = np.array([peak for peak in resonances(ratios) if 0.3 < peak < 1.6])
    assert largest_error(ratios, even, levels, peaks) > AXIS.accuracy_db


def share_at_resonances(ratios: ChainRatios, eta: np.ndarray) -> float:
    """Part of the points that lie within 0.005 of a resonance: that is a tenth of the axis."""
    distance = np.min(np.abs(np.subtract.outer(eta, resonances(ratios))), axis=1)
    return float(np.mean(distance < 0.005))


def added(curve: AdaptiveCurve, axis: AdaptiveAxis, ratios: ChainRatios) -> np.ndarray:
    """Points that refinement has added; the first ones lie at the resonances anyway."""
    return np.setdiff1d(curve.evaluated, axis.start(resonances(ratios).tolist()))


def test_points_crowd_at_resonances(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three times as many as on an even grid, or as where every interval is halved whatever the curve does."""
    ratios, even = ChainRatios(), np.linspace(0.3, 1.6, 1001)
    assert share_at_resonances(ratios, even) == pytest.approx(0.108, abs=0.003)
    curve = curve_of(ratios, AXIS)
    least = 3 * share_at_resonances(ratios, even)
    assert share_at_resonances(ratios, added(curve, AXIS, ratios)) > least
    monkeypatch.setattr(adaptive_grid, "MARGIN", -1.0)
    blind_axis = dataclasses.replace(AXIS, most_points=len(curve.evaluated))
    blind = curve_of(ratios, blind_axis)
    assert len(blind.evaluated) == len(curve.evaluated)
    assert share_at_resonances(ratios, added(blind, blind_axis, ratios)) < least / 2


def test_straight_line_needs_one_halving() -> None:
    curve = AdaptiveCurve(AXIS)
    stages = 0
    while curve.due:
        curve.add({eta: 10 * eta for eta in curve.due})
        stages += 1
    assert stages == 2
    assert len(curve.evaluated) == 2 * START_POINTS - 1


@pytest.mark.parametrize("guard", [{"least_spacing": 0.01}, {"most_points": 40}])
def test_guards_end_the_refinement_and_say_that_the_curve_is_not_resolved(guard: dict[str, float]) -> None:
    axis = dataclasses.replace(AXIS, **guard)
    curve = curve_of(ChainRatios(), axis)
    assert not curve.resolved
    assert len(curve.evaluated) <= axis.most_points


def test_least_spacing_holds_for_every_point_that_is_added() -> None:
    axis = dataclasses.replace(AXIS, least_spacing=0.01)
    curve = AdaptiveCurve(axis)
    while curve.due:
        curve.add({eta: closed_form(ChainRatios(), eta) for eta in curve.due})
    assert np.min(np.diff(curve.evaluated)) >= 0.01 * (1 - 1e-12)


def test_places_without_a_steady_state_do_not_hold_up_the_rest() -> None:
    curve = AdaptiveCurve(AXIS)
    while curve.due:
        curve.add({eta: math.nan if 0.8 < eta < 1.0 else 100 * eta**4 for eta in curve.due})
    eta, levels = curve.points
    known = ~np.isnan(levels)
    assert known.sum() > START_POINTS
    between = np.linspace(1.1, 1.6, 101)
    error = PchipInterpolator(eta[known], levels[known])(between) - [level(100 * eta**4) for eta in between]
    assert np.max(np.abs(error)) < AXIS.accuracy_db


def test_nothing_to_interpolate_is_an_end_too() -> None:
    curve = AdaptiveCurve(AXIS)
    curve.add(dict.fromkeys(curve.due, math.nan))
    assert curve.due == ()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"first": 0.0}, r"frequency_ratio.first = 0 is outside its range; allowed: > 0"),
        ({"last": 0.2}, r"frequency_ratio.last = 0.2; allowed: > first = 0.3"),
        ({"accuracy_db": -1.0}, r"frequency_ratio.accuracy_db = -1 is outside its range; allowed: > 0"),
        ({"least_spacing": 0.0}, r"frequency_ratio.least_spacing = 0 is outside its range; allowed: > 0"),
        ({"most_points": 3}, r"frequency_ratio.most_points = 3 .*>= 17"),
    ],
)
def test_axis_outside_its_range_is_refused(change: dict[str, float], message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        dataclasses.replace(AXIS, **change)
