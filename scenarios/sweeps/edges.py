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
from scenarios.sweeps.table import GivesResults, GridPoint, results_at, table_of, with_results
from scenarios.tasks.result import Result, ResultStatus
from scenarios.verdicts.band_edge import Crossing, compare_edge
from scenarios.verdicts.pointwise import CONVERGED, PointResults, baseline, refinements
from scenarios.verdicts.steady_case import REFERENCE, amplification, amplitude_in_db
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
    """Refine all edges of all curves together, and compare them with those of what each variant is compared with."""
    results: dict[CurveKey, list[Result]] = {}
    for variant, case, result in zip(table["variant"], table["case"], table["result"], strict=True):
        results.setdefault((variant, case), []).append(result)
    refined = _refined(sweep, table, evaluator)
    lacking = {key for key, own in results.items() if any(result.status is ResultStatus.MISSING for result in own)}
    refined.incomplete.update(lacking)
    known = results_at(sweep, table) | _results_at_edges(sweep, list(results), refined, evaluator)
    return tuple(
        _judged(key, edge, own, refined, known, baseline(key[0], sweep.tolerance))
        for key, own in results.items()
        for edge in Edge
    )


def _results_at_edges(
    sweep: Sweep, curves: Sequence[CurveKey], refined: _Refined, evaluator: GivesResults
) -> dict[GridPoint, PointResults]:
    """Evaluate every curve whose own error counts at the converged edges, where that error is what moves its edge."""
    points = {
        (owner, case, expected.frequency_ratio)
        for variant, case in curves
        if refinements(variant, sweep.tolerance)
        for edge in Edge
        if (expected := refined.crossings.get(((CONVERGED, case), edge))) is not None
        and not math.isnan(expected.frequency_ratio)
        for owner in (variant, REFERENCE, CONVERGED)
    }
    order = {variant: number for number, variant in enumerate(sweep.variants)}
    table = table_of(sorted(points, key=lambda point: (order[point[0]], point[1].values, point[2])))
    if table.empty:
        return {}
    evaluated = with_results(sweep, table, evaluator)
    missing = evaluated[[result.status is ResultStatus.MISSING for result in evaluated["result"]]]
    refined.incomplete.update(zip(missing["variant"], missing["case"], strict=True))
    return results_at(sweep, evaluated)


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
    key: CurveKey,
    edge: Edge,
    results: Sequence[Result],
    refined: _Refined,
    known: Mapping[GridPoint, PointResults],
    against: Variant,
) -> BandEdge:
    """Compare an edge with that of the baseline."""
    variant, case = key
    expected_edge = (against, case), edge
    crossing, expected = refined.crossings.get((key, edge)), refined.crossings.get(expected_edge)
    eta = None if crossing is None else crossing.frequency_ratio
    lacking = [owner for owner in dict.fromkeys((variant, against)) if (owner, case) in refined.incomplete]
    if all(result.status is ResultStatus.BLOCKED for result in results):
        return BandEdge(variant, case, edge, eta, Comparison(Verdict.BLOCKED, results[0].reason))
    if lacking:
        curves = " and ".join(f"{owner.title}'s curve" for owner in lacking)
        comparison = Comparison(Verdict.INCONCLUSIVE, f"{curves}: points are not evaluated so far")
        return BandEdge(variant, case, edge, math.nan if variant in lacking else eta, comparison)
    places = () if expected is None else (*refined.brackets[expected_edge], expected.frequency_ratio)
    around = [known[variant, case, place] for place in places if (variant, case, place) in known]
    return BandEdge(variant, case, edge, eta, compare_edge(crossing, expected, around, against))
