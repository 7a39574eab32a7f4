"""Frequency grids that put their points where a curve bends: at resonances and at the edges of bands.

A curve begins with even points and the natural frequencies of its chain. The middle of each interval is predicted from
the points there are, and run: where the prediction is wrong by more than the accuracy, both halves are treated alike.
All of that follows from the points that are there, so that `missing` is a function of them.
"""

import itertools
import math
from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import Annotated, Self

import numpy as np
import scipy.linalg
from pydantic import BaseModel, ConfigDict, Field, model_validator
from scipy.interpolate import PchipInterpolator

from multibody_xval.scenarios.model import LARGEST_DECIBEL, Case
from multibody_xval.scenarios.ruler.judge import FLOOR_DB
from reference_lcp.chain.linear_response import stuck_basis
from reference_lcp.errors import ParameterError
from reference_lcp.validation import LARGEST_PARAMETER

START_POINTS = 17
"""Even points with which a curve begins."""

MOST_VALUES = 1_000_000
"""Most values of one axis."""

LONGEST_CHAIN = 1000
"""Most cells of a chain whose natural frequencies are taken, before any run: 3 s, and eight times as long for twice."""

MARGIN = 0.5
"""Part of the accuracy that the prediction of a middle may miss by: the largest error lies beside the middle."""

Positive = Annotated[float, Field(gt=0, le=LARGEST_PARAMETER, allow_inf_nan=False)]
Decibel = Annotated[float, Field(gt=0, le=LARGEST_DECIBEL, allow_inf_nan=False)]

Interval = tuple[float, float]


class AdaptiveGrid(BaseModel):
    """Frequency ratios from the first to the last, as many as the accuracy needs."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    first: Positive
    last: Positive
    accuracy_db: Decibel
    """Largest error of the interpolated curve [dB], of `level` as a function of η_r."""
    least_spacing: Positive = 5e-5
    """Smallest distance of neighbours in η_r; figure 3's frictionless curve needs 1.3e-4 at 0.5 dB."""
    most_points: Annotated[int, Field(ge=START_POINTS, le=MOST_VALUES)] = 500
    """Points of a curve at which refinement ends."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.last <= self.first:
            raise ParameterError(f"last = {self.last:g}; allowed: > first = {self.first:g}")
        return self

    def start(self, peaks: Iterable[float] = ()) -> list[float]:
        """Give the frequencies with which a curve begins: `peaks` inside, and even ones where there is none."""
        inside = {round(peak, 4) for peak in peaks if self.first < round(peak, 4) < self.last}
        even, spacing = np.linspace(self.first, self.last, START_POINTS, retstep=True)
        clear = [eta for eta in even[1:-1].tolist() if all(abs(eta - peak) > spacing / 4 for peak in inside)]
        return sorted({self.first, *clear, *inside, self.last})


def missing(grid: AdaptiveGrid, peaks: Iterable[float], levels_db: Mapping[float, float]) -> list[float]:
    """Give the frequencies that a curve needs next, by its levels [dB] so far; NaN where there is no steady state."""
    due, known, halved = grid.start(peaks), dict[float, float](), list[Interval]()
    while due and all(eta in levels_db for eta in due):
        found = {eta: level(levels_db[eta]) for eta in due}
        intervals = _halves(grid, known, found, halved) if known else _steady_intervals(found)
        known |= found
        halved = _chosen(grid, intervals, len(known))
        due = [_middle(own) for own in halved]
    return [eta for eta in due if eta not in levels_db]


def level(transmittance_db: float) -> float:
    """Give 10 log10(T² + floor²) [dB], a transmittance with a floor: antiresonances are not worth following."""
    return 10 * math.log10(10 ** (transmittance_db / 10) + 10 ** (FLOOR_DB / 10))


def _middle(interval: Interval) -> float:
    return (interval[0] + interval[1]) / 2


def _steady_intervals(found: Mapping[float, float]) -> list[Interval]:
    """Give the intervals between the steady states with which a curve begins."""
    return list(itertools.pairwise(sorted(eta for eta in found if not math.isnan(found[eta]))))


def _halves(
    grid: AdaptiveGrid, known: Mapping[float, float], found: Mapping[float, float], halved: list[Interval]
) -> list[Interval]:
    """Give both halves of the intervals whose middle was predicted wrong."""
    eta = np.array(sorted(own for own in known if not math.isnan(known[own])))
    predicted = PchipInterpolator(eta, [known[own] for own in eta.tolist()])
    wrong = [own for own in halved if abs(predicted(_middle(own)) - found[_middle(own)]) > MARGIN * grid.accuracy_db]
    return [half for a, b in wrong for half in ((a, _middle((a, b))), (_middle((a, b)), b))]


def _chosen(grid: AdaptiveGrid, intervals: list[Interval], known: int) -> list[Interval]:
    """Give the intervals that may be halved; the widest first where points run short."""
    wide = [(a, b) for a, b in intervals if b - a >= 2 * grid.least_spacing]
    return sorted(sorted(wide, key=lambda own: own[0] - own[1])[: max(grid.most_points - known, 0)])


@lru_cache(maxsize=4096)
def resonances(case: Case) -> tuple[float, ...]:
    """Give the natural frequencies over ω_r of the chain with free and with stuck contacts, ascending.

    Between them, the transmittance of every friction ratio is smooth; narrow peaks are at them.
    """
    chain = case.chain
    found = []
    for basis in (np.eye(2 * chain.cells), stuck_basis(chain)):
        stiffness, mass = (basis.T @ matrix @ basis for matrix in (chain.stiffness_matrix, chain.mass_matrix))
        found += np.sqrt(scipy.linalg.eigh(stiffness, mass, eigvals_only=True)).tolist()
    return tuple(sorted(value / chain.resonator_frequency for value in found))
