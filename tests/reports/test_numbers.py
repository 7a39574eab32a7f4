"""Numbers as people read them."""

import math

import pytest

from multibody_xval.reports import formatting as numbers


@pytest.mark.parametrize(
    ("shown", "expected"),
    [
        (numbers.fixed(-9.5611, 2), "−9.56"),
        (numbers.fixed(-0.001, 2), "0.00"),
        (numbers.fixed(math.nan, 2), "–"),
        (numbers.signed(0.01234), "+0.012"),
        (numbers.signed(-0.5), "−0.50"),
        (numbers.signed(-2.1e-12), "0"),
        (numbers.signed(0.0), "0"),
        (numbers.signed(math.nan), "–"),
        (numbers.significant(14.734), "15"),
        (numbers.significant(7294.0), "7,300"),
        (numbers.significant(0.12503), "0.13"),
        (numbers.significant(0.125), "0.13"),
        (numbers.significant(1.0), "1.0"),
        (numbers.signed(0.5), "+0.50"),
        (numbers.significant(0.0995), "0.10"),
        (numbers.significant(2.14e-5), "2.1e−05"),
        (numbers.scientific(3.14e-9), "3.1e−09"),
        (numbers.scientific(0.0), "0"),
        (numbers.ratio(0.30000000000000004), "0.3"),
        (numbers.span([400, 400]), "400"),
        (numbers.span([400, 1200, 800]), "400–1200"),
        (numbers.span([]), "–"),
    ],
)
def test_numbers_are_rounded_with_true_signs(shown: str, expected: str) -> None:
    assert shown == expected


def test_a_minus_of_a_number_is_a_true_one_and_that_of_a_word_is_none() -> None:
    shown = numbers.typeset("off by -0.5 dB and 1e-05, mass-in-mass, 3.3.7-rc1")
    assert shown == "off by −0.5 dB and 1e−05, mass-in-mass, 3.3.7-rc1"


def test_indices_are_set_low_and_the_rest_is_escaped() -> None:
    assert numbers.typeset("η_r < 1, ω_max & batch_lanes") == (
        "η<sub>r</sub> &lt; 1, ω<sub>max</sub> &amp; batch_lanes"
    )
