"""Numbers as people read them."""

import math

import pytest

from multibody_xval.reports import formatting as numbers


@pytest.mark.parametrize(
    ("shown", "expected"),
    [
        (numbers.significant(14.734), "15"),
        (numbers.significant(7294.0), "7,300"),
        (numbers.significant(0.12503), "0.13"),
        (numbers.significant(0.125), "0.13"),
        (numbers.significant(1.0), "1.0"),
        (numbers.significant(-0.5), "−0.50"),
        (numbers.significant(-2.1e-12), "0"),
        (numbers.significant(0.0), "0"),
        (numbers.significant(math.nan), "–"),
        (numbers.significant(0.0995), "0.10"),
        (numbers.significant(2.14e-5), "2.1e−05"),
    ],
)
def test_numbers_are_rounded_with_true_signs(shown: str, expected: str) -> None:
    assert shown == expected
