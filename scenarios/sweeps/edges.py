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
from scenarios.sweeps.table import GivesResults, Place, known_at
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
    """What the refinement of all edges has found.

    Parameters
    ----------
    brackets
        Neighbouring frequency ratios of the grid between which each edge lies.
    crossings
        Where each edge is.
    unanswered
        Curves that lack a result, on the grid or on the way.
    """

    brackets: dict[tuple[CurveKey, Edge], tuple[float, float]]
    crossings: dict[tuple[CurveKey, Edge], Crossing]
    unanswered: set[CurveKey]


def band_edges(sweep: Sweep, table: pd.DataFrame, evaluator: GivesResults) -> tuple[BandEdge, ...]:
    """Refine all edges of all curves together, and compare them with the converged reference's."""
    results: dict[CurveKey, list[Result]] = {}
    for variant, case, result in zip(table["variant"], table["case"], table["result"], strict=True):
        results.setdefault((variant, case), []).append(result)
    refined = _refined(sweep, table, evaluator)
    lacking = {key for key, found in results.items() if any(one.status is ResultStatus.MISSING for one in found)}
    refined.unanswered.update(lacking)
    known = known_at(sweep, table)
    return tuple(_judged(key, edge, results[key], refined, known) for key in results for edge in Edge)


def _refined(sweep: Sweep, table: pd.DataFrame, evaluator: GivesResults) -> _Refined:
    """Refine every edge that the grid holds."""
    brackets = {
        (key, edge): bracket
        for key, curve in curves_of(table).items()
        for edge, bracket in edge_brackets(*curve, sweep.band).items()
    }
    owners = [key for key, _ in brackets]
    unanswered: set[CurveKey] = set()
    open_db: dict[int, float] = defaultdict(float)

    def transmittance_db(index: NDArray[np.intp], eta: FloatArray) -> FloatArray:
        places = [(*owners[k], one) for k, one in zip(index, eta.tolist(), strict=True)]
        found = evaluator.evaluate([sweep.task(*place) for place in places])
        for k, place, result in zip(index, places, found, strict=True):
            if result.status is ResultStatus.MISSING:
                unanswered.add(place[:2])
            open_db[k] = max(open_db[k], _left_open_db(sweep, place, result))
        return np.array([decided_db(result) for result in found])

    found = refined_crossings(list(brackets.values()), transmittance_db, sweep.band)
    crossings = {
        edge: replace(crossing, residual_db=open_db[k])
        for k, (edge, crossing) in enumerate(zip(brackets, found, strict=True))
    }
    return _Refined(brackets, crossings, unanswered)


def _left_open_db(sweep: Sweep, place: Place, result: Result) -> float:
    """What a motion that decides a side without being certified leaves open of its transmittance [dB]."""
    if result.converged or not result.residual <= EDGE_RESIDUAL:
        return 0.0
    _, case, eta = place
    return amplitude_in_db(result.residual * amplification(sweep.ratios_of(case), eta), sweep.band.threshold_db)


def _judged(
    key: CurveKey, edge: Edge, results: Sequence[Result], refined: _Refined, known: Mapping[Place, PointResults]
) -> BandEdge:
    """Compare one edge with the converged reference's."""
    variant, case = key
    baseline = (CONVERGED, case), edge
    crossing, expected = refined.crossings.get((key, edge)), refined.crossings.get(baseline)
    found = None if crossing is None else crossing.frequency_ratio
    lacking = [one for one in dict.fromkeys((variant, CONVERGED)) if (one, case) in refined.unanswered]
    if all(result.status is ResultStatus.BLOCKED for result in results):
        return BandEdge(variant, case, edge, found, Comparison(Verdict.BLOCKED, results[0].reason))
    if lacking:
        whose = " and ".join(f"{one.title}'s curve" for one in lacking)
        comparison = Comparison(Verdict.INCONCLUSIVE, f"{whose}: points are not answered so far")
        return BandEdge(variant, case, edge, math.nan if variant in lacking else found, comparison)
    around = [known[variant, case, eta] for eta in refined.brackets.get(baseline, ())]
    return BandEdge(variant, case, edge, found, compare_edge(crossing, expected, around))
