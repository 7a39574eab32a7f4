"""Error bars against the exact solver, and the order of the scheme that they rest on."""

import numpy as np
import pytest

from reference_lcp import Chain, HarmonicBase, ParameterError, exact_steady_state, steady_state
from reference_lcp.accuracy.convergence import convergence
from reference_lcp.accuracy.error_bar import measured_error_bar
from reference_lcp.accuracy.richardson import SAFETY
from reference_lcp.chain.simulation import steps_per_period_for

COVERED = 0.95
"""Part of random chains whose true error the bar must cover."""

WIDEST_MEDIAN = 10.0
"""Largest median of the bar over the true error."""

ROUND_OFF_DB = 1e-6
"""Where residuals of 1e-8 leave the transmittance uncertain by as much, errors are not told from round-off."""


def random_setting(rng):
    """Cells 1…10; mass, stiffness, damping and frequency ratio over a decade each; friction ratio 0.01…3."""

    def decade(low, high):
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    chain = Chain.from_ratios(
        cells=int(rng.integers(1, 11)), mass_ratio=decade(0.3, 3), stiffness_ratio=decade(0.3, 3),
        damping_ratio=decade(0.003, 0.03), friction_ratio=decade(0.01, 3),
    )  # fmt: skip
    return chain, HarmonicBase.from_ratio(chain, decade(0.3, 3))


def bar_and_error(chain, drive):
    """Error bar and true error [dB] at the coarsest step, both NaN where there is no steady state."""
    steady = steady_state(chain, drive)
    exact = exact_steady_state(chain, drive)
    if not (steady.orbit.converged and exact.orbit.converged):
        return np.nan, np.nan
    return steady.error_bar.transmittance_db, abs(steady.transmittance_db - exact.transmittance_db)


def check_coverage(count, seed):
    rng = np.random.default_rng(seed)
    bars, errors = np.array([bar_and_error(*random_setting(rng)) for _ in range(count)]).T
    known = np.isfinite(bars) & np.isfinite(errors)
    assert np.mean(known) > 0.97
    covered = bars[known] + ROUND_OFF_DB >= errors[known]
    assert np.mean(covered) >= COVERED
    assert np.median(bars[known] / np.maximum(errors[known], ROUND_OFF_DB)) <= WIDEST_MEDIAN


def test_error_bar_covers_the_true_error_of_random_chains() -> None:
    check_coverage(15, seed=1)


@pytest.mark.slow
def test_error_bar_covers_the_true_error_of_200_random_chains() -> None:
    check_coverage(200, seed=2)


@pytest.mark.parametrize(
    ("friction", "ratio"), [(0.1, 0.6), (0.3, 0.6), (0.3, 0.9), (0.6, 0.9), (0.6, 1.3), (1.0, 0.9)]
)
def test_scheme_is_of_first_order_in_transmittance_and_in_transition_times(friction, ratio) -> None:
    chain = Chain.from_ratios(friction_ratio=friction)
    study = convergence(chain, HarmonicBase.from_ratio(chain, ratio))
    assert len(study.steps_per_period) == 7
    assert study.transmittance_order == pytest.approx(1.0, abs=0.15)
    assert study.transition_order == pytest.approx(1.0, abs=0.15)


def test_error_bar_halves_with_the_step() -> None:
    chain = Chain.from_ratios(friction_ratio=0.3)
    drive = HarmonicBase.from_ratio(chain, 0.9)
    bars = [measured_error_bar(chain, drive, steps) for steps in (800, 1600, 3200)]
    ratios = [bars[k].transmittance_db / bars[k + 1].transmittance_db for k in range(2)]
    assert ratios == pytest.approx([2.0, 2.0], rel=0.3)
    assert bars[-1].steps_per_period == (3200, 6400, 12800)


def test_extrapolated_value_is_closer_than_the_computed_one() -> None:
    chain = Chain.from_ratios(friction_ratio=0.6)
    drive = HarmonicBase.from_ratio(chain, 1.3)
    steady = steady_state(chain, drive, with_exact_value=True)
    plain = abs(steady.transmittance_db - steady.exact_db)
    assert abs(steady.error_bar.extrapolated_db - steady.exact_db) < plain / 5
    assert steady.error_bar.order == pytest.approx(1.0, abs=0.3)
    assert plain <= steady.error_bar.transmittance_db <= 4 * SAFETY * plain


def test_stuck_fraction_has_an_error_bar_too() -> None:
    chain = Chain.from_ratios(friction_ratio=0.3)
    drive = HarmonicBase.from_ratio(chain, 0.9)
    steady, exact = steady_state(chain, drive), exact_steady_state(chain, drive)
    assert np.all(np.abs(steady.stuck_fraction - exact.stuck_fraction) <= steady.error_bar.stuck_fraction)


def test_error_bar_that_was_not_requested_is_absent() -> None:
    chain = Chain.from_ratios(friction_ratio=0.3)
    drive = HarmonicBase.from_ratio(chain, 0.9)
    assert "error_bar_db" not in steady_state(chain, drive, with_error_bar=False).as_dict()
    answer = steady_state(chain, drive, solver="exact", with_exact_value=True).as_dict()
    assert answer["exact_db"] == answer["transmittance_db"]


def test_steps_below_three_are_refused() -> None:
    chain = Chain.from_ratios()
    with pytest.raises(ParameterError, match="steps_per_period = 2"):
        measured_error_bar(chain, HarmonicBase.from_ratio(chain, 0.9), 2)
    assert steps_per_period_for(chain, HarmonicBase.from_ratio(chain, 0.9)) == 400
