"""Numbers as people read them."""

import math

from multibody_xval.reports.formatting import significant

NUMBERS = {14.734: "15", 7294.0: "7,300", 0.125: "0.13", 1.0: "1.0", -0.5: "−0.50", -2.1e-12: "0", 2.14e-5: "2.1e−05"}


def test_numbers_are_rounded_with_true_signs() -> None:
    assert {number: significant(number) for number in NUMBERS} == NUMBERS
    assert significant(math.nan) == "–"
