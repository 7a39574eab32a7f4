"""What the laws of variants say of the points and edges at which these disagree: deviation, prediction, what is left.

The rule is that of `multibody_xval.scenarios.verdicts.prediction`: at a point that disagrees, the law's own steady
state and a period of engine and law from the same state; of an edge that disagrees, the edge of the law's own curve.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.result import Result, ResultStatus
from multibody_xval.scenarios.runs.task import Recorded
from multibody_xval.scenarios.sweeps.edges import BandEdge, RefinedEdges, refined_edges
from multibody_xval.scenarios.sweeps.point import GivesResults, Point, point_findings, point_resolution
from multibody_xval.scenarios.sweeps.refinement import Results
from multibody_xval.scenarios.sweeps.sweep import Sweep
from multibody_xval.scenarios.verdicts.finding import Comparison, Finding, Verdict
from multibody_xval.scenarios.verdicts.prediction import LawPeriod, needs_prediction, with_predictions
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE


def predicted(sweep: Sweep, points: Sequence[Point], evaluator: GivesResults) -> list[Point]:
    """Give judged points, the findings of those that deviate or say nothing with what the law of the variant says."""
    laws = {
        point.place: law
        for point in points
        if any(needs_prediction(finding) for finding in point.findings) and (law := point.variant.law) is not None
    }
    steady = evaluator.evaluate([sweep.task(law, case, eta) for (_, case, eta), law in laws.items()])
    tasks = [sweep.task(*place).recording(Recorded.LAW) for place in laws]
    periods = map(LawPeriod.of, tasks, evaluator.evaluate(tasks))
    known = {
        place: (law, own, period)
        for (place, law), own, period in zip(laws.items(), steady, periods, strict=True)
        if own.status is not ResultStatus.MISSING
    }
    return [_predicted_point(point, *known[point.place]) if point.place in known else point for point in points]


def _predicted_point(point: Point, law: Variant, own: Result, period: LawPeriod) -> Point:
    """Give a point with what its law says."""
    of_law = replace(point, variant=law, result=own, others=())
    of_law = replace(of_law, findings=point_findings(of_law))
    judged = with_predictions(_with_resolution(point), _with_resolution(of_law), {point.label: period})
    pairs = zip(point.findings, judged, strict=True)
    return replace(point, findings=tuple(_as_judged(finding, one) for finding, one in pairs))


def _as_judged(finding: Finding, judged: Finding) -> Finding:
    """Give a finding with what its law says, its own resolution kept."""
    comparison = replace(finding.comparison, verdict=judged.comparison.verdict, reason=judged.comparison.reason)
    return replace(finding, comparison=comparison, prediction=judged.prediction)


def _with_resolution(point: Point) -> list[Finding]:
    """Give findings with what the result leaves open, also where a tolerance is given."""
    left_open = (point_resolution(point, finding.metric, point.expected) for finding in point.findings)
    return [
        replace(finding, comparison=replace(finding.comparison, resolution=size))
        for finding, size in zip(point.findings, left_open, strict=True)
    ]


def predicted_edges(
    sweep: Sweep, results: Results, edges: Sequence[BandEdge], evaluator: GivesResults
) -> tuple[BandEdge, ...]:
    """Give judged edges, those that disagree with what the law of the variant says."""
    open_edges = [edge for edge in edges if edge.comparison.verdict is Verdict.DISAGREE and edge.variant.law]
    curves = dict.fromkeys((edge.variant, edge.case) for edge in open_edges)
    places = [place for key in curves for place in results if place[:2] == key]
    grid = [(law, case, eta) for variant, case, eta in places if (law := variant.law) is not None]
    own = dict(zip(grid, evaluator.evaluate([sweep.task(*place) for place in grid]), strict=True))
    references = {place: result for place, result in results.items() if place[0] == REFERENCE}
    of_laws = refined_edges(sweep, references | own, evaluator)
    etas = [edge.expected if edge.frequency_ratio is None else edge.frequency_ratio for edge in open_edges]
    tasks = [
        sweep.task(edge.variant, edge.case, eta).recording(Recorded.LAW)
        for edge, eta in zip(open_edges, etas, strict=True)
        if eta is not None
    ]
    periods = {
        edge: LawPeriod.of(task, result)
        for edge, task, result in zip(open_edges, tasks, evaluator.evaluate(tasks), strict=True)
        if result.status is not ResultStatus.MISSING
    }
    return tuple(_predicted_edge(edge, of_laws, periods[edge]) if edge in periods else edge for edge in edges)


def _predicted_edge(edge: BandEdge, of_laws: RefinedEdges, period: LawPeriod) -> BandEdge:
    """Give an edge with what its law says; as it is where the law's curve is not evaluated so far."""
    law = edge.variant.law
    assert law is not None, "only variants with a law are predicted"
    if (law, edge.case) in of_laws.incomplete:
        return edge
    crossing = of_laws.crossings.get((law, edge.case, edge.edge))
    own = edge.finding
    value = math.nan if crossing is None else crossing.frequency_ratio
    per_db = own.comparison.per_amplitude / (20 / math.log(10))
    width = 0.0 if crossing is None else crossing.width + crossing.residual_db * per_db
    comparison = Comparison(Verdict.AGREE, "of the law", resolution=width)
    of_law = replace(own, variant=law, value=value, comparison=comparison)
    [finding] = with_predictions([own], [of_law], {own.case: period})
    prediction = finding.prediction
    if prediction is not None and crossing is None and edge.frequency_ratio is None:
        prediction = replace(prediction, difference=0.0)  # neither has it on the grid
    return replace(edge, comparison=finding.comparison, prediction=prediction)
