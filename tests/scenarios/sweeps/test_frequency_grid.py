"""Points go where a curve bends, as a function of the points that are there."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from multibody_xval.scenarios.model import Case, linear_limits
from multibody_xval.scenarios.sweeps.frequency_grid import START_POINTS, AdaptiveGrid, level, missing, resonances

GRID = AdaptiveGrid(first=0.3, last=1.6, accuracy_db=0.5)


def free_db(eta: float) -> float:
    """Level of the paper's chain without friction, in closed form."""
    return 20 * math.log10(abs(linear_limits(Case(friction_ratio=0.0, frequency_ratio=eta))[0]))


def resolved(grid: AdaptiveGrid) -> dict[float, float]:
    peaks, levels = resonances(Case(friction_ratio=0.0, frequency_ratio=1.0)), dict[float, float]()
    while new := missing(grid, peaks, levels):
        levels |= {eta: free_db(eta) for eta in new}
    return levels


@pytest.mark.parametrize("accuracy", [0.5, 2.0])
def test_interpolated_curve_is_as_accurate_as_asked(accuracy: float) -> None:
    levels = resolved(GRID.model_copy(update={"accuracy_db": accuracy}))
    eta = np.array(sorted(levels))
    between = np.concatenate([(3 * eta[1:] + eta[:-1]) / 4, (eta[1:] + 3 * eta[:-1]) / 4])
    curve = PchipInterpolator(eta, [level(levels[own]) for own in eta.tolist()])
    errors = curve(between) - [level(free_db(own)) for own in between.tolist()]
    assert np.abs(errors).max() <= 1.5 * accuracy


def test_of_a_resolved_curve_only_what_was_taken_away_is_missing() -> None:
    levels = resolved(GRID)
    first = min(levels)
    assert missing(GRID, resonances(Case(friction_ratio=0.0, frequency_ratio=1.0)), levels) == []
    rest = {eta: own for eta, own in levels.items() if eta != first}
    assert missing(GRID, resonances(Case(friction_ratio=0.0, frequency_ratio=1.0)), rest) == [first]


def test_a_curve_begins_with_even_points_and_its_peaks_and_goes_on_where_there_are_levels() -> None:
    start = missing(GRID, [], {})
    assert len(start) == START_POINTS
    assert 0.9123 in missing(GRID, [0.91234, 5.0], {})
    assert missing(GRID, [], dict.fromkeys(start, 0.0)) == [(a + b) / 2 for a, b in pairwise(start)]
    assert missing(GRID, [], dict.fromkeys(start, math.nan)) == []
