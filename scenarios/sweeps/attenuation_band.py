"""The low-frequency attenuation band and its edges.

The band is the interval of η_r that holds the first deep attenuation (transmittance below `depth`),
extended both ways to where the transmittance crosses `threshold`. Ripple between resonances of the
pass band dips below the threshold too, but not as deep; it does not count.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import elementwise

from reference_lcp.errors import ParameterError
from reference_lcp.validation import FloatArray, checked_scalar

EDGE_RESOLUTION = 1e-6
"""Width in η_r to which an edge is bracketed; at equal step little more is allowed of it. A step of 400 a period moves
the edges of figure 3 by some fifty times as much, and a width of 1e-4 would save one steady state an edge."""

RESOLVED_SPACING = 0.0125
"""Spacing of the grid in η_r to which a curve is resolved where it runs close below the threshold."""

CLOSE_DB = 3.0
"""How close below the threshold [dB] a curve may hide a crossing: ripple of lightly damped chains reaches
half a decibel there, and bends by at most a few decibels between points of a grid of a twentieth."""


class Edge(StrEnum):
    """The two ends of the band."""

    LOWER = "lower"
    UPPER = "upper"


@dataclass(frozen=True)
class BandDefinition:
    """Definition of the attenuation band."""

    threshold_db: float = 0.0
    """Transmittance at the edges [dB]."""
    depth_db: float = -10.0
    """Transmittance below which an attenuation is deep [dB], below the threshold."""

    def __post_init__(self) -> None:
        checked_scalar("threshold_db", self.threshold_db)
        if not checked_scalar("depth_db", self.depth_db) < self.threshold_db:
            raise ParameterError(f"depth_db = {self.depth_db:g}; allowed: below threshold_db = {self.threshold_db:g}")

    def __str__(self) -> str:
        return f"first fall below {self.depth_db:g} dB, extended to where it crosses {self.threshold_db:g} dB"


@dataclass(frozen=True)
class Crossing:
    """Where a curve crosses the threshold, found by refinement with simulations."""

    frequency_ratio: float
    """η_r; NaN where the refinement met a point without a steady state."""
    slope: float = math.nan
    """Of the transmittance between the ends of the bracket [dB]; per unit of η_r."""
    width: float = 0.0
    """Of the bracket in η_r."""
    residual_db: float = 0.0
    """What motions that decided a side without being certified leave open of their transmittance [dB]."""
    level_db: float = 0.0
    """The threshold [dB]."""
    bracket: tuple[float, float] = (math.nan, math.nan)
    """Neighbouring frequency ratios of the grid between which it lies."""


def edge_brackets(
    frequency_ratios: FloatArray, transmittance_db: FloatArray, definition: BandDefinition
) -> dict[Edge, tuple[float, float]]:
    """Give the neighbouring grid points, η_r ascending, between which each edge lies.

    Points without a transmittance [dB] are passed over. An edge that the grid does not hold is left out: there is no
    deep attenuation, or the curve does not cross the threshold on that side of it.
    """
    known = np.isfinite(transmittance_db)
    eta, curve = frequency_ratios[known], transmittance_db[known]
    deep = np.flatnonzero(curve < definition.depth_db)
    if deep.size == 0:
        return {}
    first = deep[0]
    above = np.flatnonzero(curve >= definition.threshold_db)
    before, after = above[above < first], above[above > first]
    brackets = {}
    if before.size:
        brackets[Edge.LOWER] = (float(eta[before[-1]]), float(eta[before[-1] + 1]))
    if after.size:
        brackets[Edge.UPPER] = (float(eta[after[0] - 1]), float(eta[after[0]]))
    return brackets


def unresolved(frequency_ratios: FloatArray, transmittance_db: FloatArray, definition: BandDefinition) -> FloatArray:
    """Give the η_r that a grid still needs, so that no crossing between the lower edge and the depth is missed.

    They are the midpoints of intervals wider than `RESOLVED_SPACING` that lie between the bracket of
    the lower edge and the first deep attenuation and have an end less than `CLOSE_DB` below the
    threshold. Shapes as in `edge_brackets`.
    """
    lower = edge_brackets(frequency_ratios, transmittance_db, definition).get(Edge.LOWER)
    if lower is None:
        return np.empty(0)
    left, right = frequency_ratios[:-1], frequency_ratios[1:]
    highest = np.maximum(transmittance_db[:-1], transmittance_db[1:])
    deep = frequency_ratios[np.argmax(transmittance_db < definition.depth_db)]
    inside = (left >= lower[0]) & (right <= deep)
    close = highest > definition.threshold_db - CLOSE_DB
    wide = right - left > RESOLVED_SPACING * (1 + 1e-9)
    return np.round((left + right)[inside & close & wide] / 2, 6)


def refined_crossings(
    brackets: Sequence[tuple[float, float]],
    transmittance_db: Callable[[NDArray[np.intp], FloatArray], FloatArray],
    definition: BandDefinition,
    resolution: float = EDGE_RESOLUTION,
) -> list[Crossing]:
    """Narrow all brackets at once, by Chandrupatla's method, to crossings of the threshold, `resolution` wide in η_r.

    `transmittance_db` takes indices of brackets and as many η_r, and gives the transmittance [dB] of each curve there.
    A crossing is NaN where an evaluation gave no number.
    """
    checked_scalar("resolution", resolution, "> 0")
    if not brackets:
        return []

    def above_threshold(eta: FloatArray, bracket: Any) -> FloatArray:
        flat, index = np.ravel(eta), np.ravel(bracket).astype(np.intp)
        return np.reshape(transmittance_db(index, flat) - definition.threshold_db, np.shape(eta))

    low, high = np.array(brackets).T
    root = elementwise.find_root(
        above_threshold,
        (low, high),
        args=(np.arange(len(brackets), dtype=np.float64),),
        tolerances={"xatol": resolution, "xrtol": 0.0, "fatol": 0.0, "frtol": 0.0},
    )
    (left, right), (f_left, f_right) = root.bracket, root.f_bracket
    eta = np.where(root.success, interpolated_crossing(left, right, f_left, f_right), np.nan)
    with np.errstate(invalid="ignore", divide="ignore"):
        slope = (f_right - f_left) / (right - left)
    # a simulation that meets the threshold exactly ends the search, however wide the bracket is
    width = np.where((f_left == 0) | (f_right == 0), 0.0, np.abs(right - left))
    level = definition.threshold_db
    crossings = zip(eta.tolist(), slope.tolist(), width.tolist(), brackets, strict=True)
    return [Crossing(ratio, steep, wide, level_db=level, bracket=sides) for ratio, steep, wide, sides in crossings]


def interpolated_crossing(left: FloatArray, right: FloatArray, f_left: FloatArray, f_right: FloatArray) -> FloatArray:
    """Zero of the straight line through the ends of each bracket; within the bracket whatever the curve."""
    with np.errstate(invalid="ignore"):
        return np.where(f_left == f_right, left, left - f_left * (right - left) / (f_right - f_left))
