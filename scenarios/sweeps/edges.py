"""The stage of edges: both edges of the attenuation band of every curve, judged."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import pandas as pd

from engines.interface.variant import Variant
from scenarios.sweeps.attenuation_band import Edge
from scenarios.sweeps.refined_edges import RefinedEdges
from scenarios.sweeps.refinement import CurveKey
from scenarios.sweeps.sweep import Case, Sweep
from scenarios.sweeps.table import GivesResults, GridPoint, results_at, table_of, with_results
from scenarios.tasks.result import Result, ResultStatus
from scenarios.verdicts.band_edge import BAND_EDGE, compare_edge
from scenarios.verdicts.finding import Finding, Prediction
from scenarios.verdicts.pointwise import CONVERGED, PointResults, baseline, refinements
from scenarios.verdicts.steady_case import REFERENCE
from scenarios.verdicts.verdict import Comparison, Verdict


@dataclass(frozen=True)
class BandEdge:
    """One edge of the band of one curve.

    Parameters
    ----------
    variant, case, edge
        Which.
    frequency_ratio
        η_r; ``None`` where the grid does not hold it.
    comparison
        With the edge of the baseline.
    prediction
        What the law of the variant says of a disagreement.
    """

    variant: Variant
    case: Case
    edge: Edge
    frequency_ratio: float | None
    comparison: Comparison
    prediction: Prediction | None = None

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
