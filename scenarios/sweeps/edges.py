"""The stage of refined edges: both edges of the attenuation band of every curve, by simulations of its own variant."""

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from engines.interface.variant import Variant
from reference_lcp.validation import FloatArray
from scenarios.sweeps.attenuation_band import Edge, edge_brackets, refined_crossings
from scenarios.sweeps.refinement import EDGE_RESIDUAL, CurveKey, curves_of, decided_db
from scenarios.sweeps.sweep import Case, Sweep
from scenarios.sweeps.table import GivesResults, GridPoint, results_at
from scenarios.tasks.result import Result, ResultStatus
from scenarios.verdicts.band_edge import Crossing, compare_edge
from scenarios.verdicts.pointwise import CONVERGED, PointResults
from scenarios.verdicts.steady_case import amplification, amplitude_in_db
from scenarios.verdicts.verdict import Comparison, Verdict


@dataclass(frozen=True)
class BandEdge:
    """One edge of the band of one curve; `frequency_ratio` is ``None`` where the grid does not hold it."""

    variant: Variant
    case: Case
    edge: Edge
    frequency_ratio: float | None
    comparison: Comparison


@dataclass(frozen=True)
class _Refined:
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


def band_edges(sweep: Sweep, table: pd.DataFrame, evaluator: GivesResults) -> tuple[BandEdge, ...]:
    """Refine all edges of all curves together, and compare them with the converged reference's."""
    results: dict[CurveKey, list[Result]] = {}
    for variant, case, result in zip(table["variant"], table["case"], table["result"], strict=True):
        results.setdefault((variant, case), []).append(result)
    refined = _refined(sweep, table, evaluator)
    lacking = {key for key, own in results.items() if any(result.status is ResultStatus.MISSING for result in own)}
    refined.incomplete.update(lacking)
    known = results_at(sweep, table)
    return tuple(_judged(key, edge, results[key], refined, known) for key in results for edge in Edge)


def _refined(sweep: Sweep, table: pd.DataFrame, evaluator: GivesResults) -> _Refined:
    brackets = {
        (key, edge): bracket
        for key, curve in curves_of(table).items()
        for edge, bracket in edge_brackets(*curve, sweep.band).items()
    }
    owners = [key for key, _ in brackets]
    incomplete: set[CurveKey] = set()
    open_db: dict[int, float] = defaultdict(float)

    def transmittance_db(index: NDArray[np.intp], eta: FloatArray) -> FloatArray:
        points = [(*owners[k], ratio) for k, ratio in zip(index, eta.tolist(), strict=True)]
        results = evaluator.evaluate([sweep.task(*point) for point in points])
        for k, point, result in zip(index, points, results, strict=True):
            if result.status is ResultStatus.MISSING:
                incomplete.add(point[:2])
            open_db[k] = max(open_db[k], _left_open_db(sweep, point, result))
        return np.array([decided_db(result) for result in results])

    refined = refined_crossings(list(brackets.values()), transmittance_db, sweep.band)
    crossings = {
        edge: replace(crossing, residual_db=open_db[k])
        for k, (edge, crossing) in enumerate(zip(brackets, refined, strict=True))
    }
    return _Refined(brackets, crossings, incomplete)


def _left_open_db(sweep: Sweep, point: GridPoint, result: Result) -> float:
    """What a motion that decides a side without being certified leaves open of its transmittance [dB]."""
    if result.converged or not result.residual <= EDGE_RESIDUAL:
        return 0.0
    _, case, eta = point
    return amplitude_in_db(result.residual * amplification(sweep.ratios_of(case), eta), sweep.band.threshold_db)


def _judged(
    key: CurveKey, edge: Edge, results: Sequence[Result], refined: _Refined, known: Mapping[GridPoint, PointResults]
) -> BandEdge:
    variant, case = key
    baseline = (CONVERGED, case), edge
    crossing, expected = refined.crossings.get((key, edge)), refined.crossings.get(baseline)
    eta = None if crossing is None else crossing.frequency_ratio
    lacking = [owner for owner in dict.fromkeys((variant, CONVERGED)) if (owner, case) in refined.incomplete]
    if all(result.status is ResultStatus.BLOCKED for result in results):
        return BandEdge(variant, case, edge, eta, Comparison(Verdict.BLOCKED, results[0].reason))
    if lacking:
        curves = " and ".join(f"{owner.title}'s curve" for owner in lacking)
        comparison = Comparison(Verdict.INCONCLUSIVE, f"{curves}: points are not evaluated so far")
        return BandEdge(variant, case, edge, math.nan if variant in lacking else eta, comparison)
    around = [known[variant, case, end] for end in refined.brackets.get(baseline, ())]
    return BandEdge(variant, case, edge, eta, compare_edge(crossing, expected, around))
