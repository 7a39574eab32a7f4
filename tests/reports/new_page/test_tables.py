"""Tables and figures of the page: small cases, exact answers."""

import pytest

from multibody_xval.reports.new_page.figures import phases
from multibody_xval.reports.new_page.tables import error_text


def test_an_error_says_how_many_points_it_leaves_out() -> None:
    assert error_text(0.1234, 5, 5) == "0.12"
    assert error_text(0.1234, 5, 4) == "0.12*"
    assert error_text(0.1234, 3, 1) == "not periodic"


def test_the_last_phase_of_a_period_goes_on_in_the_next() -> None:
    found = phases([0.25, 0.75], ["stick", "forward slip"])
    assert found == [(0.0, 0.25, "forward slip"), (0.25, 0.5, "stick"), (0.75, 0.25, "forward slip")]
    assert sum(length for _, length, _ in found) == pytest.approx(1)
