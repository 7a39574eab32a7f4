"""Frequency grids that put their points where the curve bends: at resonances and at the edges of bands.

A curve begins with even points and the natural frequencies of its chain. Then the middle of each interval is
predicted from the points there are, by monotone cubic interpolation, and evaluated: where the prediction is wrong by
more than the accuracy, both halves are refined in the same way. So each part of the curve ends with points that
were predicted right before they were added.
"""

import itertools
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import ConfigDict, Field
from scipy.interpolate import PchipInterpolator

from multibody_xval.scenarios.runs.parameters import Decibel, Positive
from multibody_xval.scenarios.verdicts.finding import FLOOR_DB
from reference_lcp.errors import ParameterError
from reference_lcp.validation import LARGEST_PARAMETER, FloatArray, checked_count, checked_scalar

START_POINTS = 17
"""Even points with which a curve begins."""

LEAST_SPACING = 5e-5
"""Smallest distance of neighbours in η_r unless one is given; figure 3's frictionless curve needs 1.3e-4 at 0.5 dB."""

MOST_POINTS = 500
"""Points after which a curve is left as it is unless a number is given."""

MOST_VALUES = 1_000_000
"""Most values of one axis: they are in memory, 100 MB of them, while the points of a grid are not."""

MARGIN = 0.5
"""Part of the accuracy that the prediction of a middle may miss by.

The largest error lies beside the middle, and a middle may be right by chance. On the frictionless chain, whose
curve is known between the points too, the largest error is then at most 1.4 times the accuracy at 0.1 dB, and below
the accuracy at 0.5 and 2 dB.
"""


@dataclass(frozen=True, kw_only=True)
class AdaptiveAxis:
    """Frequency ratios from the first to the last, as many as the accuracy needs."""

    __pydantic_config__ = ConfigDict(extra="forbid")

    first: Positive
    last: Positive
    """Ends of the axis in η_r, 0 < first < last."""
    accuracy_db: Decibel
    """Largest error of the interpolated curve [dB], > 0, of `level` as a function of η_r."""
    least_spacing: Positive = LEAST_SPACING
    """Smallest distance of neighbours in η_r, > 0; what is sharper is left unresolved."""
    most_points: Annotated[int, Field(ge=START_POINTS, le=MOST_VALUES, strict=True)] = MOST_POINTS
    """Points of a curve at which refinement ends, >= `START_POINTS`."""

    def __post_init__(self) -> None:
        for name in ("first", "last", "accuracy_db", "least_spacing"):
            checked_scalar(f"grid.frequency_ratio.{name}", getattr(self, name), "> 0", LARGEST_PARAMETER)
        checked_count("grid.frequency_ratio.most_points", self.most_points, START_POINTS, MOST_VALUES)
        if self.last <= self.first:
            raise ParameterError(f"grid.frequency_ratio.last = {self.last:g}; allowed: > first = {self.first:g}")

    def start(self, peaks: Iterable[float] = ()) -> tuple[float, ...]:
        """Frequencies with which a curve begins: `peaks` that lie inside, and even ones where there is none."""
        inside = {round(peak, 4) for peak in peaks if self.first < round(peak, 4) < self.last}
        even, spacing = np.linspace(self.first, self.last, START_POINTS, retstep=True)
        clear = [eta for eta in even[1:-1].tolist() if all(abs(eta - peak) > spacing / 4 for peak in inside)]
        return tuple(sorted({self.first, *clear, *inside, self.last}))


def level(transmittance_db: float) -> float:
    """Give the transmittance with a floor: 10 log10(T² + floor²) [dB], as good as T itself 20 dB above `FLOOR_DB`.

    Antiresonances reach −∞ dB, and nothing is gained by following them.
    """
    return 10 * math.log10(10 ** (transmittance_db / 10) + 10 ** (FLOOR_DB / 10))


class AdaptiveCurve:
    """The points of one curve, and those that it needs next: `due`, which is empty once the curve is done.

    `peaks` are frequencies of narrow peaks that are known beforehand. The curve is `resolved` if no interval was left
    as it is for the sake of spacing or number of points.
    """

    def __init__(self, axis: AdaptiveAxis, peaks: Iterable[float] = ()):
        self._axis = axis
        self._values: dict[float, float] = {}
        self._open: list[tuple[float, float]] = []
        self.due = axis.start(peaks)
        self.resolved = True

    @property
    def evaluated(self) -> tuple[float, ...]:
        """Frequencies evaluated so far, ascending."""
        return tuple(sorted(self._values))

    @property
    def points(self) -> tuple[FloatArray, FloatArray]:
        """Frequencies evaluated so far, ascending, and the `level` [dB] there; NaN without a steady state."""
        eta = np.array(self.evaluated)
        return eta, np.array([self._values[ratio] for ratio in eta.tolist()])

    def add(self, transmittance_db: Mapping[float, float]) -> None:
        """Take the transmittance [dB] at every frequency that was due; NaN where there is none.

        Halves of an interval whose middle has no steady state are not refined.
        """
        if self._values:
            predicted = self._interpolant()
            levels = {eta: level(transmittance_db[eta]) for eta in self.due}
            wrong = {eta for eta in levels if abs(predicted(eta) - levels[eta]) > MARGIN * self._axis.accuracy_db}
            bends = [(a, b) for a, b in self._open if (a + b) / 2 in wrong]
            halves = [half for a, b in bends for half in ((a, (a + b) / 2), ((a + b) / 2, b))]
        else:
            known = sorted(eta for eta in self.due if not math.isnan(transmittance_db[eta]))
            halves = list(itertools.pairwise(known))
        self._values.update((eta, level(transmittance_db[eta])) for eta in self.due)
        self._choose(halves)

    def _interpolant(self) -> PchipInterpolator:
        eta, values = self.points
        known = ~np.isnan(values)
        return PchipInterpolator(eta[known], values[known])

    def _choose(self, intervals: list[tuple[float, float]]) -> None:
        """Take the intervals that may be halved; the widest first where points run short."""
        wide = [(a, b) for a, b in intervals if b - a >= 2 * self._axis.least_spacing]
        room = self._axis.most_points - len(self._values)
        self._open = sorted(sorted(wide, key=lambda interval: interval[0] - interval[1])[: max(room, 0)])
        self.resolved = self.resolved and len(self._open) == len(intervals)
        self.due = tuple((a + b) / 2 for a, b in self._open)
