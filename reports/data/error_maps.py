"""Where every variant is off, and how far: its error to the truth over the cases of a sweep and frequency."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from engines.interface.variant import Variant
from reference_lcp.validation import FloatArray
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.sweep import Case
from scenarios.sweeps.truths import Truths, truth_errors
from scenarios.verdicts.pointwise import CONVERGED

MOST_ROWS = 24
"""Cases beyond which their rows are too thin to be told apart."""


@dataclass(frozen=True)
class ErrorMap:
    """Errors of one variant.

    Parameters
    ----------
    variant
        Which.
    cases
        Rows, from below.
    frequency_ratios
        Columns, ascending: those of all cases together.
    error_db
        Transmittance less the true one [dB], shape (cases, frequency ratios); NaN where the truth is too small to be
        compared with, see `FLOOR_DB`, or there is no steady state. A case without a point at a frequency has there
        what it has at the nearest of its own.
    unsteady
        Points without a steady state that can be compared, as (number of the case, frequency ratio).
    """

    variant: Variant
    cases: tuple[Case, ...]
    frequency_ratios: FloatArray
    error_db: FloatArray
    unsteady: tuple[tuple[int, float], ...]

    @property
    def known(self) -> bool:
        """Whether any error is known."""
        return bool(np.isfinite(self.error_db).any())


def error_maps(result: ComparedSweep, truths: Truths, order: Sequence[Variant]) -> list[ErrorMap]:
    """Give the map of each of the variants in this order, but for the converged reference, which has next to no error.

    There is none where the sweep is one curve, or more than can be told apart.
    """
    if not 1 < len(result.cases) <= MOST_ROWS:
        return []
    errors = {point[:3]: error.error_db for point, error in truth_errors(result, truths, result.points)}
    comparable = {place for place, truth in truths.items() if truth.above_floor}
    etas = np.array(sorted({point.frequency_ratio for point in result.points}))
    maps = [_error_map(result, variant, etas, errors, comparable) for variant in order if variant != CONVERGED]
    return [own for own in maps if own.known]


def _error_map(
    result: ComparedSweep,
    variant: Variant,
    etas: FloatArray,
    errors: Mapping[tuple[Variant, Case, float], float],
    comparable: set[tuple[Case, float]],
) -> ErrorMap:
    """Give the map of one variant; `comparable` are the points at which the truth is large enough."""
    rows = np.full((len(result.cases), etas.size), np.nan)
    unsteady = []
    for number, case in enumerate(result.cases):
        own = [(p.frequency_ratio, errors.get(p[:3], np.nan)) for p in result.curve(variant, case)]
        shown = [(eta, error if (case, eta) in comparable else np.nan) for eta, error in own]
        unsteady += [(number, eta) for eta, error in shown if (case, eta) in comparable and np.isnan(error)]
        rows[number] = _nearest(shown, etas)
    return ErrorMap(variant, result.cases, etas, rows, tuple(unsteady))


def _nearest(points: Sequence[tuple[float, float]], etas: FloatArray) -> FloatArray:
    """Give the value of the nearest of some points, ascending, at every frequency ratio."""
    if not points:
        return np.full(etas.size, np.nan)
    own, values = np.array(points).T
    right = np.clip(np.searchsorted(own, etas), 1, max(own.size - 1, 1))
    if own.size == 1:
        return np.full(etas.size, values[0])
    nearest: FloatArray = np.where(etas - own[right - 1] <= own[right] - etas, values[right - 1], values[right])
    return nearest
