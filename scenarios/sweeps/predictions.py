"""What the laws of variants say of the points and edges at which these disagree: departure, prediction, what is left.

The rule is that of `scenarios.verdicts.prediction`: at a point that disagrees, the law's own steady state and a period
of engine and law from the same state; of an edge that disagrees, the edge of the law's own curve.
"""

import math
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import replace

import pandas as pd

from engines.interface.variant import Variant
from scenarios.runs.result import Result, ResultStatus
from scenarios.runs.task import Recorded
from scenarios.sweeps.edges import BandEdge, RefinedEdges, largest_amplification, refined_edges
from scenarios.sweeps.sweep import Sweep
from scenarios.sweeps.table import (
    GivesResults,
    GridPoint,
    Point,
    grid_points_of,
    points_of,
    results_at,
    table_of,
    with_columns,
)
from scenarios.verdicts.finding import Comparison, Finding, Verdict
from scenarios.verdicts.pointwise import PointResults, baseline, point_findings, point_resolution
from scenarios.verdicts.prediction import LawPeriod, needs_prediction, with_predictions


def predicted(sweep: Sweep, table: pd.DataFrame, evaluator: GivesResults) -> pd.DataFrame:
    """Give a judged table, the findings of points that depart or say nothing with what the law of the variant says."""
    rows = points_of(table)
    known = results_at(sweep, table)
    open_points = {
        number: law
        for number, row in enumerate(rows)
        if any(needs_prediction(finding) for finding in row.findings) and (law := row.variant.law) is not None
    }
    results = _law_results(sweep, [(rows[number][:3], law) for number, law in open_points.items()], evaluator)
    findings = [row.findings for row in rows]
    for (number, law), (own, period) in zip(open_points.items(), results, strict=True):
        if own.status is not ResultStatus.MISSING:
            findings[number] = _predicted_point(rows[number], known[rows[number][:3]], law, own, period)
    return with_columns(table, findings=findings)


def _law_results(
    sweep: Sweep, points: Sequence[tuple[GridPoint, Variant]], evaluator: GivesResults
) -> list[tuple[Result, LawPeriod]]:
    """Give the steady state of the law at each point, and the period of engine and law."""
    steady = evaluator.evaluate([sweep.task(law, case, eta) for (_, case, eta), law in points])
    tasks = [sweep.task(*point).recording(Recorded.LAW) for point, _ in points]
    periods = map(LawPeriod.of, tasks, evaluator.evaluate(tasks))
    return list(zip(steady, periods, strict=True))


def _predicted_point(
    point: Point, known: PointResults, law: Variant, own: Result, period: LawPeriod
) -> tuple[Finding, ...]:
    """Give the findings of a point with what its law says."""
    of_law = replace(known, variant=law, result=own, others=())
    label = point.findings[0].case
    judged = with_predictions(
        _with_resolution(point.findings, known),
        _with_resolution(point_findings(of_law, label), of_law),
        {label: period},
    )
    return tuple(
        replace(finding, prediction=own.prediction) for finding, own in zip(point.findings, judged, strict=True)
    )


def _with_resolution(findings: Iterable[Finding], known: PointResults) -> list[Finding]:
    """Give findings with what the result leaves open, also where a tolerance is given."""
    return [
        replace(
            finding,
            comparison=replace(finding.comparison, resolution=point_resolution(known, known.against, finding.metric)),
        )
        for finding in findings
    ]


def predicted_edges(
    sweep: Sweep, table: pd.DataFrame, edges: Sequence[BandEdge], refined: RefinedEdges, evaluator: GivesResults
) -> tuple[BandEdge, ...]:
    """Give judged edges, those that disagree with what the law of the variant says."""
    open_edges = [edge for edge in edges if edge.comparison.verdict is Verdict.DISAGREE and edge.variant.law]
    if not open_edges:
        return tuple(edges)
    curves = _curves_of_laws(sweep, table, open_edges, evaluator)
    of_laws = refined_edges(sweep, curves, evaluator, largest_amplification(table))
    places = [_place(sweep, edge, refined) for edge in open_edges]
    tasks = [
        sweep.task(edge.variant, edge.case, eta).recording(Recorded.LAW)
        for edge, eta in zip(open_edges, places, strict=True)
    ]
    results = evaluator.evaluate(tasks)
    periods = {
        edge: LawPeriod.of(task, result)
        for edge, task, result in zip(open_edges, tasks, results, strict=True)
        if result.status is not ResultStatus.MISSING
    }
    return tuple(_predicted_edge(edge, of_laws, periods[edge]) if edge in periods else edge for edge in edges)


def _curves_of_laws(
    sweep: Sweep, table: pd.DataFrame, edges: Iterable[BandEdge], evaluator: GivesResults
) -> pd.DataFrame:
    """Evaluate the curve of the law on the whole grid of every case in which an edge is to be predicted."""
    etas = defaultdict(list)
    for variant, case, eta in grid_points_of(table):
        etas[variant, case].append(eta)
    points = [
        (law, case, eta)
        for (variant, law, case) in dict.fromkeys((edge.variant, edge.variant.law, edge.case) for edge in edges)
        for eta in etas[variant, case]
        if law is not None
    ]
    return with_columns(table_of(points), result=evaluator.evaluate([sweep.task(*point) for point in points]))


def _place(sweep: Sweep, edge: BandEdge, refined: RefinedEdges) -> float:
    """Give the frequency ratio of an edge that disagrees; where the variant has none, that of its baseline."""
    if edge.frequency_ratio is not None:
        return edge.frequency_ratio
    against = baseline(edge.variant, sweep.tolerance)
    return refined.crossings[(against, edge.case), edge.edge].frequency_ratio


def _predicted_edge(edge: BandEdge, of_laws: RefinedEdges, period: LawPeriod) -> BandEdge:
    """Give an edge with what its law says; as it is where the law's curve is not evaluated so far."""
    law = edge.variant.law
    assert law is not None, "only variants with a law are predicted"
    if (law, edge.case) in of_laws.incomplete:
        return edge
    crossing = of_laws.crossings.get(((law, edge.case), edge.edge))
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
    return replace(edge, prediction=prediction)
