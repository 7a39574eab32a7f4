"""The one estimate of the error of a step, on numbers whose limit is known."""

import math

import numpy as np
import pytest

from reference_lcp.errors import ParameterError
from reference_lcp.steady.richardson import (
    ROUND_OFF,
    SAFETY,
    amplitude_in_db,
    richardson,
    richardson_error,
    unresolved_amplitude,
)

LIMIT = -3.0


def values(first, second, steps):
    """A scheme whose error has parts of the first and of the second order."""
    return [LIMIT + first / count + second / count**2 for count in steps]


@pytest.mark.parametrize("steps", [(1, 2), (1, 2, 4), (3, 4), (2, 5, 7), (1, 2, 4, 32)])
def test_first_order_error_is_found_whatever_the_steps(steps) -> None:
    for at, value in zip(steps, values(0.1, 0.0, steps), strict=True):
        estimate = richardson(steps, values(0.1, 0.0, steps), at)
        # nothing stands beside the finest of three, and two pairs add up
        looks = 2 if at == steps[-1] and len(steps) > 2 else 1
        assert estimate.value == value
        assert estimate.error == pytest.approx(looks * SAFETY * abs(value - LIMIT))
        assert estimate.extrapolated == pytest.approx(LIMIT)


@pytest.mark.parametrize(("first", "second"), [(0.1, 0.0), (0.0, 0.1), (0.12, -0.1), (0.1, -0.2), (-0.1, 0.3)])
@pytest.mark.parametrize("at", [1, 2, 4])
def test_three_steps_cover_the_error_of_each_of_them(first, second, at) -> None:
    """For (0.1, −0.2) the two middle values are both off by nothing or by little."""
    estimate = richardson((1, 2, 4), values(first, second, (1, 2, 4)), at)
    assert estimate.error >= abs(estimate.value - LIMIT)


def test_one_difference_that_vanishes_by_chance_is_not_believed() -> None:
    assert richardson((400, 800, 1600), [1.0, 1.0, 1.1], 400).error == pytest.approx(SAFETY * 0.4)
    assert richardson((400, 800, 1600), [1.0, 1.1, 1.1]).error == pytest.approx(SAFETY * 0.05)


def test_order_is_read_from_steps_that_grow_by_one_factor() -> None:
    assert richardson((100, 200, 400), values(0.1, 0.0, (100, 200, 400))).order == pytest.approx(1)
    assert richardson((10, 30, 90), values(0.0, 5.0, (10, 30, 90))).order == pytest.approx(2)
    assert math.isnan(richardson((10, 20, 90), values(0.1, 0.0, (10, 20, 90))).order)
    assert math.isnan(richardson((1, 2, 4), [1.0, 1.0, 1.0]).order)


@pytest.mark.parametrize(
    ("steps", "numbers", "at", "message"),
    [
        ((800, 400), [1.0, 2.0], None, "ascending"),
        ((400, 800), [1.0], None, "with 1 values"),
        ((400, 800), [1.0, 2.0], 600, "at = 600"),
    ],
)
def test_what_tells_nothing_of_an_error_is_refused(steps, numbers, at, message) -> None:
    with pytest.raises(ParameterError, match=message):
        richardson(steps, numbers, at)


@pytest.mark.parametrize("steps", [(100, 200), (100, 200, 400), (10, 30, 90, 91)])
def test_the_error_of_a_number_is_that_of_an_array_of_one(steps) -> None:
    numbers = np.random.default_rng(5).normal(size=(len(steps), 20))
    for at in (None, *steps):
        each = [richardson_error(steps, tuple(column), at) for column in numbers.T.tolist()]
        assert each == pytest.approx(richardson(steps, numbers, at).error, rel=1e-12)
    unknown = (math.nan, *[1.0] * (len(steps) - 1))
    assert math.isnan(richardson_error(steps, unknown, steps[-1]))
    assert math.isnan(richardson(steps, unknown, steps[-1]).error)


def test_what_is_not_resolved_is_the_residual_amplified_and_round_off() -> None:
    """Round-off grows as the root of the steps, and is that of the largest motion."""
    assert unresolved_amplitude(1e-8, 50.0, 16_000, -200.0) == pytest.approx(5e-7 + ROUND_OFF, rel=1e-12)
    assert unresolved_amplitude(0.0, 50.0, 4 * 16_000, -200.0) == pytest.approx(2 * ROUND_OFF)
    assert unresolved_amplitude(0.0, 1.0, 16_000, 40.0) == pytest.approx(100 * ROUND_OFF)
    assert unresolved_amplitude(0.0, 1.0, 16_000, -math.inf) == pytest.approx(ROUND_OFF)


def test_change_of_the_amplitude_in_decibel() -> None:
    assert amplitude_in_db(9.0, 0.0) == pytest.approx(20.0)
    assert amplitude_in_db(-0.09, -20.0) == pytest.approx(-20.0)
    assert amplitude_in_db(-0.1, -20.0) == -math.inf
