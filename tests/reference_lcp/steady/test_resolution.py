"""What residual and round-off leave open, in numbers that can be computed by hand."""

import math

import pytest

from reference_lcp.steady.richardson import ROUND_OFF, amplitude_in_db, unresolved_amplitude


def test_residual_is_amplified_and_round_off_grows_as_the_root_of_the_steps() -> None:
    assert unresolved_amplitude(1e-8, 50.0, 16_000, -200.0) == pytest.approx(5e-7 + ROUND_OFF, rel=1e-12)
    assert unresolved_amplitude(0.0, 50.0, 4 * 16_000, -200.0) == pytest.approx(2 * ROUND_OFF)


def test_round_off_is_that_of_the_largest_motion() -> None:
    assert unresolved_amplitude(0.0, 1.0, 16_000, 40.0) == pytest.approx(100 * ROUND_OFF)
    assert unresolved_amplitude(0.0, 1.0, 16_000, -math.inf) == pytest.approx(ROUND_OFF)


def test_change_of_the_amplitude_in_decibel() -> None:
    assert amplitude_in_db(9.0, 0.0) == pytest.approx(20.0)
    assert amplitude_in_db(-0.09, -20.0) == pytest.approx(-20.0)
    assert amplitude_in_db(-0.1, -20.0) == -math.inf
