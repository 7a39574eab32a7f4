"""Error bars against the exact motion of random chains, far below −100 dB too."""

import dataclasses
import math
from contextlib import nullcontext
from types import SimpleNamespace

import numpy as np
import pytest

import reference_lcp.steady.error_bar
import reference_lcp.studies.against_exact
from reference_lcp import ParameterError
from reference_lcp.steady.richardson import SAFETY
from reference_lcp.studies import against_exact
from reference_lcp.studies.against_exact import (
    Convergence,
    Coverage,
    compared_with_exact,
    coverage,
    plot_convergence,
    random_setting,
)

COVERED = 0.97
"""Part of the exact values that bars must cover."""

WIDEST_MEDIAN = 10.0
"""Largest median of the bar over the true error."""

SEED = 0

DEEP = 33
"""Chain of nine cells at −187 dB by the scheme and −192 dB in truth; its three steps differ by 1 dB only."""

UNSTABLE = 189
"""Chain of three cells with two sticks that are shorter than the coarsest step."""


BRIEF = (611, 221)
"""Seed and chain of nine cells, one of which sticks for 0.0014 periods at a reversal; no step of the three shows it."""


def test_the_line_of_first_order_ends_at_the_corner_of_the_figure(tmp_path, monkeypatch) -> None:
    figure = pytest.importorskip("matplotlib.figure")
    drawn = []
    save = figure.Figure.savefig
    monkeypatch.setattr(
        figure.Figure, "savefig", lambda self, *args, **more: drawn.append(self) or save(self, *args, **more)
    )
    study = Convergence((100, 200, 400), np.array([0.4, 0.2, 0.1]), np.array([0.04, 0.02, 0.01]), (0, 0, 0))
    monkeypatch.setattr(against_exact, "replacing", nullcontext)
    plot_convergence({"(0.3, 0.9)": study}, tmp_path / "orders.png")
    for axes, largest in zip(drawn[0].axes, (0.4, 0.04), strict=True):
        curve, line = axes.get_lines()
        (left, right), (low, high) = line.get_xdata(), line.get_ydata()
        assert high / low == pytest.approx(right / left)
        assert largest < high < 1.5 * largest
        assert right < 1.5 * max(curve.get_xdata())


def numbers(of, quantity):
    """Margins of one quantity at the coarsest step."""
    return next(row.margins for row in of if (row.quantity, row.refinement) == (quantity, 1))


def test_floor_holds_the_exact_transmittance_of_a_deep_chain() -> None:
    rows = compared_with_exact(*random_setting(SEED, DEEP))
    assert numbers(rows, "transmittance") == ()
    assert min(numbers(rows, "floor of transmittance")) >= 1
    assert numbers(rows, "transmittance below −100 dB") == numbers(rows, "floor of transmittance")


def test_bar_of_the_step_alone_misses_the_exact_transmittance_of_a_deep_chain(monkeypatch) -> None:
    monkeypatch.setattr(reference_lcp.steady.error_bar, "unresolved_amplitude", lambda *_: 0.0)
    rows = compared_with_exact(*random_setting(SEED, DEEP))
    assert max(numbers(rows, "transmittance")) < 0.5


def test_sticks_that_finer_steps_show_only_are_flagged(monkeypatch) -> None:
    rows = compared_with_exact(*random_setting(SEED, UNSTABLE))
    assert [row.inconclusive for row in rows if row.quantity == "transition time"] == [4, 4, 4]
    assert min(numbers(rows, "transition time")) >= 1
    measured = reference_lcp.studies.against_exact.error_bar
    monkeypatch.setattr(
        reference_lcp.studies.against_exact,
        "error_bar",
        lambda orbits, place: dataclasses.replace(measured(orbits, place), missing_transitions=[]),
    )
    missed = numbers(compared_with_exact(*random_setting(SEED, UNSTABLE)), "transition time")
    assert missed.count(0.0) == 4


def test_stick_that_no_step_shows_is_flagged(monkeypatch) -> None:
    rows = compared_with_exact(*random_setting(*BRIEF))
    assert [row.inconclusive for row in rows if row.quantity == "transition time"] == [4, 4, 4]
    assert min(numbers(rows, "transition time")) >= 1
    assert min(numbers(rows, "stuck fraction")) >= 1
    monkeypatch.setattr(reference_lcp.steady.error_bar, "MARGINAL_STEPS", 0)
    rows = compared_with_exact(*random_setting(*BRIEF))
    assert numbers(rows, "transition time").count(0.0) == 2


def test_phase_has_a_bar_that_covers_the_exact_one() -> None:
    (margin,) = numbers(compared_with_exact(*random_setting(*BRIEF)), "phase")
    assert 1 <= margin <= WIDEST_MEDIAN


def test_shares_and_medians_are_those_of_the_margins() -> None:
    row = Coverage("transmittance", 2, (0.5, 1.1, 1.3, math.inf))
    assert row.covered() == 0.75
    assert row.covered(SAFETY) == 0.5
    assert row.median_margin == pytest.approx(1.2)
    assert row.as_dict() == {
        "quantity": "transmittance", "refinement": 2, "compared": 4, "inconclusive": 0, "covered": 0.75,
        "covered_without_safety": 0.5, "median_bar_over_error": pytest.approx(1.2),
    }  # fmt: skip
    assert Coverage("stuck fraction", 1, ()).as_dict()["covered"] is None


def test_chains_are_the_same_however_many_there_are() -> None:
    assert coverage(2, seed=4).rows[0].margins == coverage(3, seed=4).rows[0].margins[:2]


@pytest.mark.parametrize(("chains", "seed", "message"), [(0, 0, "chains = 0"), (1, -1, "seed = -1")])
def test_counts_below_their_least_are_refused(chains, seed, message) -> None:
    with pytest.raises(ParameterError, match=message):
        coverage(chains, seed)


def check(study, quantities):
    assert study.uncertified <= 0.03 * study.chains
    for row in study.rows:
        if row.quantity in quantities:
            assert row.covered() >= COVERED, row
            assert row.quantity.startswith("floor") or row.median_margin <= WIDEST_MEDIAN, row


def test_bars_cover_the_exact_values_of_random_chains() -> None:
    check(coverage(8, seed=2), ("transmittance", "floor of transmittance", "transition time"))


@pytest.mark.slow
def test_bars_cover_the_exact_values_of_200_random_chains() -> None:
    known = ("transmittance", "floor of transmittance", "phase", "stuck fraction", "transition time")
    check(coverage(200, seed=1), known)


def test_contacts_that_stick_all_the_time_or_never_have_no_error_to_cover(monkeypatch) -> None:
    monkeypatch.setattr(reference_lcp.studies.against_exact, "stuck_fraction", lambda _: np.array([1.0, 0.0, 1.0, 0.0]))
    bar, exact = (
        SimpleNamespace(stuck_fraction=np.full(4, 0.2)),
        SimpleNamespace(stuck_fraction=np.array([1.0, 0.0, 0.9, 0.1])),
    )
    margins = reference_lcp.studies.against_exact._stuck_margins(None, bar, exact)
    assert margins == pytest.approx([2.0, 2.0])
