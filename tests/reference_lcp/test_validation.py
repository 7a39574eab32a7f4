"""Arguments that are outside their range: the message has the range."""

import re

import pytest

from reference_lcp.errors import ParameterError
from reference_lcp.validation import check_record_size, checked_array


@pytest.mark.parametrize(
    ("value", "requirement", "message"),
    [
        ([1.0, 1e25], "> 0", "x = 1e+25 is outside its range; allowed: > 0, 1e-24 to 1e+24"),
        ([1.0, 1e-25], "> 0", "x = 1e-25 is outside its range; allowed: > 0, 1e-24 to 1e+24"),
        ([0.0, 1e25], ">= 0", "x = 1e+25 is outside its range; allowed: >= 0, 1e-24 to 1e+24"),
        ([0.0, 1.0], "> 0", "x = 0 is outside its range; allowed: > 0, 1e-24 to 1e+24"),
        ([0.0, -1.0], ">= 0", "x = -1 is outside its range; allowed: >= 0, 1e-24 to 1e+24"),
    ],
)
def test_the_message_has_value_and_range(value, requirement, message) -> None:
    with pytest.raises(ParameterError, match=f"^{re.escape(message)}$"):
        checked_array("x", value, requirement, largest=1e24)


def test_zeros_and_the_ends_of_the_range_are_in_it() -> None:
    assert checked_array("x", [0.0, 0.0], ">= 0", largest=1e24).tolist() == [0.0, 0.0]
    assert checked_array("x", [0.25, 4.0], "> 0", largest=4.0).tolist() == [0.25, 4.0]


def test_a_record_that_is_too_long_is_refused_with_its_size() -> None:
    check_record_size(100, 10)
    with pytest.raises(ParameterError, match=re.escape("1000 cells x 2000000 steps are 2e+09; allowed")):
        check_record_size(1000, 2_000_000)
