"""Arguments that are outside their range: the message has the range."""

import re

import pytest

from reference_lcp.errors import ParameterError
from reference_lcp.validation import check_record_size, checked_array


@pytest.mark.parametrize(
    ("value", "requirement", "allowed"),
    [
        ([0.0, 1.0], "> 0", "x = 0 is outside its range; allowed: > 0, 0.25 to 4"),
        ([1.0, 5.0], "> 0", "x = 5 is outside its range; allowed: > 0, 0.25 to 4"),
        ([0.0, 0.2], ">= 0", "x = 0.2 is outside its range; allowed: >= 0, 0.25 to 4"),
        ([0.0, -1.0], ">= 0", "x = -1 is outside its range; allowed: >= 0, 0.25 to 4"),
        ([0.0, 0.25, 4.0], ">= 0", None),
        ([0.25, 4.0], "> 0", None),
    ],
)
def test_a_number_outside_its_range_is_refused_with_the_range_whose_ends_are_in_it(value, requirement, allowed) -> None:
    if allowed is None:
        assert checked_array("x", value, requirement, largest=4.0).tolist() == value
        return
    with pytest.raises(ParameterError, match=f"^{re.escape(allowed)}$"):
        checked_array("x", value, requirement, largest=4.0)


def test_a_record_that_is_too_long_is_refused_with_its_size() -> None:
    check_record_size(100, 10)
    with pytest.raises(ParameterError, match=re.escape("1000 cells x 2000000 steps are 2e+09; allowed")):
        check_record_size(1000, 2_000_000)
