"""First roots of polynomials on [0, 1]: none missed, close pairs and touches included."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.polynomial import Polynomial

from reference_lcp.exact.polynomial_roots import ROOT_TOLERANCE, first_roots


def first_root(polynomial: Polynomial, size: int = 21) -> float:
    coefficients = np.zeros((size, 1))
    coefficients[: polynomial.coef.size, 0] = polynomial.coef
    return float(first_roots(coefficients)[0])


@settings(max_examples=200, deadline=None)
@given(st.lists(st.integers(-64, 96).filter(bool), min_size=1, max_size=6, unique=True), st.sampled_from([29, 32]))
def test_first_root_is_the_smallest_one_on_the_interval(numerators, denominator) -> None:
    """With 32 as denominator roots fall on the ends of halved intervals, where signs are round-off."""
    roots = [numerator / denominator for numerator in numerators]
    # Round-off decides whether a root at the very end is in this interval or at the start of the next one.
    assume(1.0 not in roots)
    polynomial = Polynomial.fromroots(roots)
    polynomial = polynomial * float(np.sign(polynomial(0.0)))
    inside = [root for root in roots if 0 < root <= 1]
    assert first_root(polynomial) == pytest.approx(min(inside, default=np.inf), abs=1e-7)


@pytest.mark.parametrize("gap", [1e-2, 1e-4, 1e-6, 3e-7])
def test_pair_of_close_roots_is_not_missed(gap) -> None:
    """A force that passes its bound for 3e-7 of the interval only."""
    pair = Polynomial.fromroots([0.3141 - gap / 2, 0.3141 + gap / 2])
    assert first_root(pair) == pytest.approx(0.3141 - gap / 2, abs=1e-15 / gap + 1e-15)
    apart = pair + gap**2 / 2
    assert first_root(apart) == np.inf


def test_passing_zero_by_more_than_round_off_is_told_from_reaching_it() -> None:
    for touch in (0.3, 0.5, 0.7):
        assert first_root(Polynomial.fromroots([touch, touch]) - 1e-14) == pytest.approx(touch, abs=2e-7)
        assert first_root(Polynomial.fromroots([touch, touch]) + 1e-14) == np.inf


def test_root_at_the_end_of_the_interval_counts() -> None:
    assert first_root(Polynomial([1.0, -1.0])) == pytest.approx(1.0)


def changes_sign_at(coefficients, root: float) -> bool:
    """Whether the polynomial, in exact arithmetic, is positive just before a place and negative just behind it."""

    def value(s: Fraction) -> Fraction:
        return sum((Fraction(float(a)) * s**k for k, a in enumerate(coefficients)), Fraction(0))

    return (
        value(Fraction(root) - 2 * Fraction(ROOT_TOLERANCE)) > 0 > value(Fraction(root) + 2 * Fraction(ROOT_TOLERANCE))
    )


@pytest.mark.parametrize("seed", range(40))
def test_series_of_a_motion_change_their_sign_at_the_root_and_not_before(seed) -> None:
    """Coefficients fall as those of a motion over one span; places 1e-13 away are told from the root."""
    rng = np.random.default_rng(seed)
    coefficients = rng.normal(0, 1, 21) / np.cumprod([1, *range(1, 21)])
    coefficients[0] = abs(coefficients[0]) / 3
    root, places = float(first_roots(coefficients[:, None])[0]), np.linspace(0, 1, 10_001)[1:]
    assert np.all(Polynomial(coefficients)(places[places < root]) > 0)
    if root < np.inf:
        assert changes_sign_at(coefficients, root)
        assert not changes_sign_at(coefficients, root + 1e-13)
        assert not changes_sign_at(coefficients, root - 1e-13)
