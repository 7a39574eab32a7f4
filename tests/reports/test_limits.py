"""Limits of axes: from the data, never noise over the whole axis, never so wide that differences are lost."""

import math

import pytest

from multibody_xval.reports.figures.limits import decade_limits, level_limits


@pytest.mark.parametrize(
    ("levels", "limits"),
    [
        ([-33.0, 12.0], (-40.0, 20.0)),
        ([-3.0, -3.0 + 1e-9], (-10.0, 10.0)),
        ([-300.0, 5.0], (-110.0, 10.0)),
        ([math.nan, -math.inf, -5.0], (-10.0, 10.0)),
        ([], (-20.0, 0.0)),
    ],
)
def test_an_axis_of_levels_ends_at_tens_and_spans_20_to_120_db(levels, limits) -> None:
    assert level_limits(levels) == limits


@pytest.mark.parametrize(
    ("sizes", "limits"),
    [([0.12, 15.0], (0.1, 100.0)), ([1e-9, 2e-9], (1e-4, 1e-2)), ([math.nan, 0.001], (1e-3, 1e-1)), ([], (1e-4, 1e-2))],
)
def test_an_axis_of_errors_has_two_decades_at_least(sizes, limits) -> None:
    assert decade_limits(sizes, 1e-4) == pytest.approx(limits, rel=1e-12)
