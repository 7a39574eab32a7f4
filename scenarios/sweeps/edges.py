"""Both edges of the attenuation band of every curve: the one definition of an edge, and the one comparison of edges.

An edge is where a curve crosses the threshold, found by simulations of the variant itself, see `refined_crossings`;
pages, maps and scenarios quote what `refined_edges` gives.

Edges are compared with those of a baseline. A change δ of the transmittance [dB] moves an edge by δ / slope. What is
allowed at the edge itself and at the two points of the grid around it, over the slope of the baseline's curve there, is
therefore what is allowed of the edge, and the widths to which both edges are bracketed besides. Likewise, what friction
changes of an edge at all is what it changes of the transmittance, over the slope. The baseline is that of the points:
presets that share the Euler scheme are compared at equal step, where nothing but resolution is allowed.
"""

import math
from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np
from numpy.typing import NDArray

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.result import Result, ResultStatus
from multibody_xval.scenarios.sweeps.attenuation_band import Crossing, Edge, edge_brackets, refined_crossings
from multibody_xval.scenarios.sweeps.point import GivesResults, Point, evaluated, tolerance, unless_own_error_is_unknown
from multibody_xval.scenarios.sweeps.refinement import EDGE_RESIDUAL, CurveKey, Results, curves_of, decided_db
from multibody_xval.scenarios.sweeps.sweep import Case, GridPoint, Sweep, baseline, refinements
from multibody_xval.scenarios.verdicts.finding import (
    TRANSMITTANCE,
    Comparison,
    Finding,
    Metric,
    Prediction,
    Tolerance,
    Verdict,
)
from multibody_xval.scenarios.verdicts.judge import decide
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED, REFERENCE, amplification
from reference_lcp.steady.richardson import amplitude_in_db
from reference_lcp.validation import FloatArray

BAND_EDGE = Metric("band edge", "in η_r", "where the transmittance crosses the threshold of the attenuation band")


@dataclass(frozen=True)
class RefinedEdges:
    """The refined edges of all curves."""

    crossings: Mapping[tuple[Variant, Case, Edge], Crossing]
    """Edges that the grid does not hold are left out."""
    incomplete: set[CurveKey]
    """Curves that lack a result, on the grid or on the way."""


def refined_edges(sweep: Sweep, results: Results, evaluator: GivesResults) -> RefinedEdges:
    """Refine all edges of all curves together, by simulations of their own variants."""
    brackets = {
        (*key, edge): bracket
        for key, curve in curves_of(results).items()
        for edge, bracket in edge_brackets(*curve, sweep.band).items()
    }
    owners = list(brackets)
    incomplete = {place[:2] for place, result in results.items() if result.status is ResultStatus.MISSING}
    amplified: dict[Case, float] = defaultdict(float)  # where that is most
    for (variant, case, _), result in results.items():
        if variant == REFERENCE:
            amplified[case] = max(amplified[case], amplification(result))
    open_db: dict[int, float] = defaultdict(float)

    def transmittance_db(index: NDArray[np.intp], eta: FloatArray) -> FloatArray:
        points = [(*owners[k][:2], ratio) for k, ratio in zip(index, eta.tolist(), strict=True)]
        found = evaluator.evaluate([sweep.task(*point) for point in points])
        for k, point, result in zip(index, points, found, strict=True):
            if result.status is ResultStatus.MISSING:
                incomplete.add(point[:2])
            if not result.converged and result.residual <= EDGE_RESIDUAL:
                growth = amplified.get(point[1], math.nan)
                open_db[k] = max(open_db[k], amplitude_in_db(result.residual * growth, sweep.band.threshold_db))
        return np.array([decided_db(result) for result in found])

    narrowed = refined_crossings(list(brackets.values()), transmittance_db, sweep.band)
    crossings = {
        edge: replace(crossing, residual_db=open_db[k])
        for k, (edge, crossing) in enumerate(zip(brackets, narrowed, strict=True))
    }
    return RefinedEdges(crossings, incomplete)


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
    expected: float | None = None
    """η_r of the baseline's edge; likewise."""

    @property
    def finding(self) -> Finding:
        """The edge as a finding."""
        value, expected = (math.nan if eta is None else eta for eta in (self.frequency_ratio, self.expected))
        label = f"{self.case}, {self.edge} edge"
        return Finding(self.variant, label, BAND_EDGE, value, expected, self.comparison, self.prediction)


def band_edges(
    sweep: Sweep, results: Results, evaluator: GivesResults, modelled: Collection[Variant] = ()
) -> tuple[BandEdge, ...]:
    """Refine all edges of curves, and compare them with those of what each variant is compared with.

    Of `modelled` variants, the model gives the error of a step where it may, see `evaluated`.
    """
    curves: dict[CurveKey, list[Result]] = defaultdict(list)
    for (variant, case, _), result in results.items():
        curves[variant, case].append(result)
    refined = refined_edges(sweep, results, evaluator)
    known = _around_edges(sweep, list(curves), refined, evaluator, modelled)
    return tuple(_judged(key, edge, own, refined, known, sweep) for key, own in curves.items() for edge in Edge)


def _around_edges(
    sweep: Sweep,
    curves: Sequence[CurveKey],
    refined: RefinedEdges,
    evaluator: GivesResults,
    modelled: Collection[Variant],
) -> dict[GridPoint, Point]:
    """Evaluate what says how far edges may be apart: points of the grid on both sides of the baseline's edge.

    Curves whose own error counts are evaluated at the edge itself too, where that error is what moves it.
    """
    places = set()
    for variant, case in curves:
        against = baseline(variant, sweep.tolerance)
        for edge in Edge:
            expected = refined.crossings.get((against, case, edge))
            if expected is None:
                continue
            etas = list(expected.bracket)
            if refinements(variant, sweep.tolerance) and not math.isnan(expected.frequency_ratio):
                etas.append(expected.frequency_ratio)
            places |= {(owner, case, eta) for owner in (variant, REFERENCE, CONVERGED) for eta in etas}
    order = {variant: number for number, variant in enumerate(sweep.variants)}
    ordered = sorted(places, key=lambda place: (order[place[0]], place[1].values, place[2]))
    points = {point.place: point for point in evaluated(sweep, ordered, evaluator, modelled)}
    refined.incomplete.update(place[:2] for place, own in points.items() if own.result.status is ResultStatus.MISSING)
    return points


def _judged(
    key: CurveKey,
    edge: Edge,
    results: Sequence[Result],
    refined: RefinedEdges,
    known: Mapping[GridPoint, Point],
    sweep: Sweep,
) -> BandEdge:
    """Compare an edge with that of the baseline."""
    variant, case = key
    against = baseline(variant, sweep.tolerance)
    crossing, expected = (refined.crossings.get((owner, case, edge)) for owner in (variant, against))
    eta, right = (None if own is None else own.frequency_ratio for own in (crossing, expected))
    lacking = [owner for owner in dict.fromkeys((variant, against)) if (owner, case) in refined.incomplete]
    if all(result.status is ResultStatus.BLOCKED for result in results):
        first = next((result for result in results if result.failed), results[0])
        comparison = Comparison(Verdict.BLOCKED, first.reason, failed=first.failed)
    elif lacking:
        curves = " and ".join(f"{owner.title}'s curve" for owner in lacking)
        comparison = Comparison(Verdict.INCONCLUSIVE, f"{curves}: points are not evaluated so far")
        eta = math.nan if variant in lacking else eta
    else:
        places = () if expected is None else (*expected.bracket, expected.frequency_ratio)
        around = [known[*key, place] for place in places if (*key, place) in known]
        comparison = compare_edge(crossing, expected, around)
    return BandEdge(variant, case, edge, eta, comparison, expected=right)


def compare_edge(edge: Crossing | None, expected: Crossing | None, around: Sequence[Point] = ()) -> Comparison:
    """Compare a band edge with that of the baseline; ``None`` is an edge outside the grid.

    `around` are the points at the expected edge, and of the grid on either side of it.
    """
    if edge is None and expected is None:
        return Comparison(Verdict.AGREE, "no such edge on the grid, for the reference neither")
    if edge is None or expected is None:
        which = "reference" if edge is None else "engine"
        return Comparison(Verdict.DISAGREE, f"only the {which} has this edge on the grid")
    if math.isnan(edge.frequency_ratio) or math.isnan(expected.frequency_ratio):
        return Comparison(Verdict.INCONCLUSIVE, "the refinement met a point without a steady state")
    known = [point for point in around if point.is_known and point.expected.converged]
    effect = min((point.effect[TRANSMITTANCE] for point in known), default=math.inf) / abs(expected.slope)
    allowed = _edge_tolerance(edge, expected, known)
    comparison = decide(BAND_EDGE, edge.frequency_ratio, expected.frequency_ratio, allowed, effect)
    # by how much a small change of the amplitude moves the edge in η_r, per displacement scale
    per_amplitude = 20 / math.log(10) * 10 ** (-expected.level_db / 20) / abs(expected.slope)
    comparison = replace(comparison, per_amplitude=per_amplitude)
    if comparison.verdict is Verdict.DISAGREE and not known:
        reason = f"{comparison.reason}; no steady state beside it gives its own error"
        return replace(comparison, verdict=Verdict.INCONCLUSIVE, reason=reason)
    for point in known:
        comparison = unless_own_error_is_unknown(point, comparison)
    return comparison


def _edge_tolerance(edge: Crossing, expected: Crossing, known: Iterable[Point]) -> Tolerance:
    """Derive how far an edge may be from the expected one in η_r: of every part, the largest around it counts."""
    sides = [asdict(tolerance(point)) for point in known]
    largest = {part: max((side[part] for side in sides), default=0.0) for part in asdict(Tolerance())}
    largest["resolution"] += edge.residual_db + expected.residual_db
    allowed = Tolerance(**largest).over(expected.slope)
    return replace(allowed, resolution=allowed.resolution + edge.width + expected.width)
