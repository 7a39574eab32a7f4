"""The stage of edges: both edges of the attenuation band of every curve, judged."""

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from engines.interface.variant import Variant
from reference_lcp.steady.richardson import amplitude_in_db
from reference_lcp.validation import FloatArray
from scenarios.runs.result import Result, ResultStatus
from scenarios.sweeps.attenuation_band import BAND_EDGE, Crossing, Edge, compare_edge, edge_brackets, refined_crossings
from scenarios.sweeps.refinement import EDGE_RESIDUAL, CurveKey, curves_of, decided_db
from scenarios.sweeps.sweep import Case, Sweep
from scenarios.sweeps.table import GivesResults, GridPoint, results_at, table_of, with_results
from scenarios.verdicts.finding import Comparison, Finding, Prediction, Verdict
from scenarios.verdicts.pointwise import CONVERGED, PointResults, baseline, refinements
from scenarios.verdicts.steady_case import REFERENCE, amplification


@dataclass(frozen=True)
class RefinedEdges:
    """The refined edges of all curves."""

    brackets: dict[tuple[CurveKey, Edge], tuple[float, float]]
    """Neighbouring frequency ratios of the grid between which each edge lies."""
    crossings: dict[tuple[CurveKey, Edge], Crossing]
    incomplete: set[CurveKey]
    """Curves that lack a result, on the grid or on the way."""


def refined_edges(
    sweep: Sweep, table: pd.DataFrame, evaluator: GivesResults, amplified: Mapping[Case, float]
) -> RefinedEdges:
    """Refine all edges of all curves of a table together, by simulations of their own variants."""
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


@dataclass(frozen=True)
class BandEdge:
    """One edge of the band of one curve."""

    variant: Variant
    case: Case
    edge: Edge
    frequency_ratio: float | None
    """η_r; ``None`` where the grid does not hold it."""
    comparison: Comparison
    prediction: Prediction | None = None
    """What the law of the variant says of a disagreement."""

    @property
    def finding(self) -> Finding:
        """The edge as a finding."""
        value = math.nan if self.frequency_ratio is None else self.frequency_ratio
        expected = value - self.comparison.difference
        label = f"{self.case}, {self.edge} edge"
        return Finding(self.variant, label, BAND_EDGE, value, expected, self.comparison, self.prediction)


def band_edges(
    sweep: Sweep, table: pd.DataFrame, refined: RefinedEdges, evaluator: GivesResults
) -> tuple[BandEdge, ...]:
    """Compare all refined edges with those of what each variant is compared with."""
    results: dict[CurveKey, list[Result]] = {}
    for variant, case, result in zip(table["variant"], table["case"], table["result"], strict=True):
        results.setdefault((variant, case), []).append(result)
    known = results_at(sweep, table) | _results_at_edges(sweep, list(results), refined, evaluator)
    return tuple(_judged(key, edge, own, refined, known, sweep) for key, own in results.items() for edge in Edge)


def _results_at_edges(
    sweep: Sweep, curves: Sequence[CurveKey], refined: RefinedEdges, evaluator: GivesResults
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


def _judged(
    key: CurveKey,
    edge: Edge,
    results: Sequence[Result],
    refined: RefinedEdges,
    known: Mapping[GridPoint, PointResults],
    sweep: Sweep,
) -> BandEdge:
    """Compare an edge with that of the baseline."""
    variant, case = key
    against = baseline(variant, sweep.tolerance)
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
    comparison = compare_edge(crossing, expected, around, against)
    return BandEdge(variant, case, edge, eta, comparison)
