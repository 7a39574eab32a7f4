"""Where the edges of the attenuation band of curves are, by simulations of each curve's own variant."""

import math
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from reference_lcp.accuracy.resolution import amplitude_in_db
from reference_lcp.validation import FloatArray
from scenarios.sweeps.attenuation_band import Edge, edge_brackets, refined_crossings
from scenarios.sweeps.refinement import EDGE_RESIDUAL, CurveKey, curves_of, decided_db
from scenarios.sweeps.sweep import Case, Sweep
from scenarios.sweeps.table import GivesResults
from scenarios.tasks.result import Result, ResultStatus
from scenarios.verdicts.band_edge import Crossing
from scenarios.verdicts.steady_case import REFERENCE, amplification


@dataclass(frozen=True)
class RefinedEdges:
    """The refined edges of all curves.

    Parameters
    ----------
    brackets
        Neighbouring frequency ratios of the grid between which each edge lies.
    crossings
        Where each edge is.
    incomplete
        Curves that lack a result, on the grid or on the way.
    """

    brackets: dict[tuple[CurveKey, Edge], tuple[float, float]]
    crossings: dict[tuple[CurveKey, Edge], Crossing]
    incomplete: set[CurveKey]


def refined_edges(
    sweep: Sweep, table: pd.DataFrame, evaluator: GivesResults, amplified: Mapping[Case, float]
) -> RefinedEdges:
    """Refine all edges of all curves of a table together, by simulations of their own variants.

    Parameters
    ----------
    sweep, table
        The sweep, and the results on its grid.
    evaluator
        Runs the simulations.
    amplified
        See `largest_amplification`.
    """
    brackets = {
        (key, edge): bracket
        for key, curve in curves_of(table).items()
        for edge, bracket in edge_brackets(*curve, sweep.band).items()
    }
    owners = [key for key, _ in brackets]
    missing = table[[result.status is ResultStatus.MISSING for result in table["result"]]]
    incomplete: set[CurveKey] = set(zip(missing["variant"], missing["case"], strict=True))
    open_db: dict[int, float] = defaultdict(float)

    def transmittance_db(index: NDArray[np.intp], eta: FloatArray) -> FloatArray:
        points = [(*owners[k], ratio) for k, ratio in zip(index, eta.tolist(), strict=True)]
        results = evaluator.evaluate([sweep.task(*point) for point in points])
        for k, point, result in zip(index, points, results, strict=True):
            if result.status is ResultStatus.MISSING:
                incomplete.add(point[:2])
            open_db[k] = max(open_db[k], _left_open_db(sweep, amplified.get(point[1], math.nan), result))
        return np.array([decided_db(result) for result in results])

    narrowed = refined_crossings(list(brackets.values()), transmittance_db, sweep.band)
    crossings = {
        edge: replace(crossing, residual_db=open_db[k])
        for k, (edge, crossing) in enumerate(zip(brackets, narrowed, strict=True))
    }
    return RefinedEdges(brackets, crossings, incomplete)


def largest_amplification(table: pd.DataFrame) -> dict[Case, float]:
    """Give by how much residuals are amplified in each case, at the point of the reference where that is most."""
    own = table[table["variant"] == REFERENCE]
    largest: dict[Case, float] = {}
    for case, result in zip(own["case"], own["result"], strict=True):
        largest[case] = max(largest.get(case, 0.0), amplification(result))
    return largest


def _left_open_db(sweep: Sweep, amplified: float, result: Result) -> float:
    """What a motion that decides a side without being certified leaves open of its transmittance [dB]."""
    if result.converged or not result.residual <= EDGE_RESIDUAL:
        return 0.0
    return amplitude_in_db(result.residual * amplified, sweep.band.threshold_db)
