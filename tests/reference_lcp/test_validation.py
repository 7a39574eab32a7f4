"""Arguments that are outside their range: the message has the range."""

import re

import numpy as np
import pytest

from reference_lcp.errors import ParameterError
from reference_lcp.validation import check_record_size, checked_array


@pytest.mark.parametrize(
    ("value", "requirement"), [(0.0, "> 0"), (5.0, "> 0"), (0.2, ">= 0"), (-1.0, ">= 0"), (np.nan, ">= 0")]
)
def test_a_number_outside_its_range_is_refused_with_the_range(value, requirement) -> None:
    message = f"x = {value:g} is outside its range; allowed: {requirement}, 0.25 to 4"
    with pytest.raises(ParameterError, match=f"^{re.escape(message)}$"):
        checked_array("x", [1.0, value], requirement, largest=4.0)


def test_zero_and_the_ends_of_the_range_are_in_it() -> None:
    assert checked_array("x", [0.0, 0.25, 4.0], ">= 0", largest=4.0).tolist() == [0.0, 0.25, 4.0]


def test_a_record_that_is_too_long_is_refused_with_its_size() -> None:
    check_record_size(100, 10)
    with pytest.raises(ParameterError, match=re.escape("1000 cells x 2000000 steps are 2e+09; allowed")):
        check_record_size(1000, 2_000_000)
