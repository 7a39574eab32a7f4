"""Where the exact motion crosses the threshold, by secants from the edge of the reference."""

import math
from collections.abc import Mapping
from typing import Any

import pandas as pd

from multibody_xval.scenarios.edges.finding import CLOSE, THRESHOLD_DB
from multibody_xval.scenarios.model import Case
from multibody_xval.scenarios.result_tables import is_exact, is_reference, rows_of
from multibody_xval.scenarios.ruler.exact_values import exact_values
from multibody_xval.scenarios.ruler.judge import DB

MOST_STEPS = 8
"""Of the search; two or three do."""

FARTHEST = 0.1
"""Part of η_r by which the step of the reference may move an edge: farther away it is another crossing."""

Levels = Mapping[Case, Mapping[float, float]]
"""Levels of the exact motion [dB] over the threshold, by curve and frequency ratio."""


def exact_levels(table: pd.DataFrame) -> Levels:
    """Give the levels of the exact motion that a table of points knows."""
    own = table[is_exact(table) | is_reference(table)]
    of_case = dict(rows_of(own, "case", "curve"))
    levels: dict[Case, dict[float, float]] = {}
    for case, exact in rows_of(exact_values(own), "case", "exact"):
        size = abs(exact)
        if size > 0:
            levels.setdefault(of_case[case], {})[case.frequency_ratio] = DB * math.log(size) - THRESHOLD_DB
    return levels


def exact_place(own: Any, levels: Levels) -> tuple[float, float, float]:
    """Give a frequency, how far the exact motion's edge is from it, and the slope there [dB per η_r].

    The distance is NaN where the exact motion is not known yet, or its edge is not found.
    """
    known, slope = levels.get(own.curve, {}), own.slope
    beside = [eta for eta in known if abs(eta - own.frequency_ratio) <= CLOSE]
    start = place = min(beside, default=round(own.frequency_ratio, 6), key=lambda eta: abs(eta - own.frequency_ratio))
    for _ in range(MOST_STEPS):
        if place not in known or not slope:
            return place, math.nan, slope
        step = -known[place] / slope
        if abs(step) <= CLOSE:
            return place, step, slope
        following = round(place + step, 9)
        if abs(following - start) > FARTHEST * start:
            break
        if following in known:
            slope = (known[following] - known[place]) / (following - place)
        place = following
    return start, math.nan, slope
