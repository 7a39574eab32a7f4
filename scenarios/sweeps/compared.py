"""A sweep whose variants are compared with the reference: grid → results → refined edges → verdicts → predictions."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.sweeps.attenuation_band import Edge
from multibody_xval.scenarios.sweeps.checks import LEAST_POINTS, Check, check_models, passed
from multibody_xval.scenarios.sweeps.edges import BandEdge, band_edges
from multibody_xval.scenarios.sweeps.point import GivesResults, Point, Truth, evaluated, judged
from multibody_xval.scenarios.sweeps.predictions import predicted, predicted_edges
from multibody_xval.scenarios.sweeps.refinement import (
    chosen_frequencies,
    decided_db,
    for_the_band,
    frequencies_of,
    refined,
)
from multibody_xval.scenarios.sweeps.sweep import Case, GridPoint, Sweep
from multibody_xval.scenarios.verdicts.finding import Finding, Metric, Prediction
from multibody_xval.scenarios.verdicts.prediction import needs_prediction
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED, REFERENCE
from reference_lcp.validation import FloatArray

DENSE_FREQUENCY_RATIOS = tuple(float(eta) for eta in np.round(np.arange(0.1, 3.005, 0.01), 2))
"""Where the reference's curves are drawn as lines."""

Curve = tuple[FloatArray, FloatArray]


@dataclass(frozen=True)
class ComparedSweep:
    """The results of a sweep, judged."""

    sweep: Sweep
    points: Sequence[Point]
    """Every point of every variant, by variant, case and frequency, judged. The grid of each case is that of the
    sweep, resolved where a curve needs more points."""
    edges: tuple[BandEdge, ...] = ()
    """Both edges of every curve; empty where nothing could refine them."""
    dense_reference: Mapping[Case, Curve] = field(default_factory=dict)
    """For each case, η_r (`DENSE_FREQUENCY_RATIOS`) and transmittance [dB] of the reference at the common time step, to
    be drawn as a line; cases without any are left out."""
    models: tuple[Check, ...] = ()
    """Of which points engines gave what their models stand in for, by variant."""

    @property
    def cases(self) -> tuple[Case, ...]:
        """Cases of the sweep, in order."""
        return self.sweep.cases

    def curve(self, variant: Variant, case: Case) -> list[Point]:
        """Points of one curve."""
        return self._curves.get((variant, case), [])

    def points_of(self, variant: Variant) -> list[Point]:
        """Points of one variant, by case and frequency."""
        return [point for case in self.cases for point in self.curve(variant, case)]

    @property
    def findings(self) -> list[Finding]:
        """Every comparison of every point and edge."""
        return [finding for point in self.points for finding in point.findings] + [edge.finding for edge in self.edges]

    def edge(self, variant: Variant, case: Case, edge: Edge) -> BandEdge:
        """One edge."""
        return self._edges[variant, case, edge]

    @cached_property
    def truths(self) -> dict[tuple[Case, float], Truth]:
        """The truth by case and frequency ratio, where it is known."""
        known = (point for point in self.points if not math.isnan(point.truth.transmittance_db))
        return {point.place[1:]: point.truth for point in known}

    @cached_property
    def _curves(self) -> dict[tuple[Variant, Case], list[Point]]:
        curves: dict[tuple[Variant, Case], list[Point]] = {}
        for point in self.points:
            curves.setdefault((point.variant, point.case), []).append(point)
        return curves

    @cached_property
    def _edges(self) -> dict[tuple[Variant, Case, Edge], BandEdge]:
        return {(edge.variant, edge.case, edge.edge): edge for edge in self.edges}


def compare_sweep(sweep: Sweep, evaluator: GivesResults, least: int = LEAST_POINTS) -> ComparedSweep:
    """Evaluate the grid, resolve it, judge every point, refine the edges of every curve, and ask the laws of variants.

    The converged reference is among the variants, see `Sweep.with_reference`. Models are checked at `least` points of
    each variant, see `check_models`.
    """
    found, models = check_models(sweep, resolved_grid(sweep, evaluator), evaluator, least)
    points = judged(found)
    results = {point.place: point.result for point in points}
    edges = band_edges(sweep, results, evaluator, passed(models))
    return ComparedSweep(
        sweep,
        predicted(sweep, points, evaluator),
        predicted_edges(sweep, results, edges, evaluator),
        _dense_reference(sweep, evaluator),
        models,
    )


def judged_points(
    sweep: Sweep,
    places: Sequence[GridPoint],
    evaluator: GivesResults,
    predictions: Mapping[GridPoint, Mapping[Metric, Prediction]],
    modelled: Collection[Variant],
) -> ComparedSweep:
    """Evaluate and judge points as they are: nothing is added, no edge is refined, and no law is run.

    `predictions` are what is known of laws, which stand in for `modelled` variants.
    """
    points = judged(evaluated(sweep, places, evaluator, modelled))
    return ComparedSweep(sweep, [_recalled(point, predictions.get(point.place, {})) for point in points])


def _recalled(point: Point, predictions: Mapping[Metric, Prediction]) -> Point:
    """Give a point with what is known of the law of its variant."""
    findings = (
        replace(own, prediction=predictions.get(own.metric)) if needs_prediction(own) else own for own in point.findings
    )
    return replace(point, findings=tuple(findings))


def resolved_grid(sweep: Sweep, evaluator: GivesResults) -> list[GridPoint]:
    """Give every variant at every point of a grid that is as fine in each case as its curves need.

    On an adaptive axis, every variant's curve chooses points, and all variants take all of them, so that they can be
    compared; then points are added until the converged reference shows no interval in which a crossing could hide.
    """
    etas = chosen_frequencies(sweep, evaluator)
    guide = [(CONVERGED, case, eta) for case in etas for eta in etas[case]]
    etas = frequencies_of(refined(sweep, guide, for_the_band(sweep), evaluator))
    return [(variant, case, eta) for variant in sweep.variants for case in etas for eta in etas[case]]


def _dense_reference(sweep: Sweep, evaluator: GivesResults) -> dict[Case, Curve]:
    """Curves of the reference over the whole range, fine enough to be drawn as lines; adaptive ones are so already."""
    if sweep.frequencies is not None:
        return {}
    low, high = min(sweep.frequency_ratios), max(sweep.frequency_ratios)
    eta = np.array([ratio for ratio in DENSE_FREQUENCY_RATIOS if low <= ratio <= high])
    tasks = [sweep.task(REFERENCE, case, ratio) for case in sweep.cases for ratio in eta.tolist()]
    levels = [decided_db(result) for result in evaluator.evaluate(tasks)]
    curves = np.reshape(levels, (len(sweep.cases), eta.size))
    return {case: (eta, curve) for case, curve in zip(sweep.cases, curves, strict=True)}
