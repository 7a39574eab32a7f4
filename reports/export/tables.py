"""Tables and the JSON file beside the page: the numbers in full."""

import math
from collections.abc import Iterable
from functools import partial
from typing import Any

import pandas as pd

from reports.data.catalogue import Outcome, Outcomes
from reports.data.departures import outcome
from reports.data.errors import VariantErrors
from reports.data.findings import Extreme, VariantFindings
from reports.data.option_curves import OptionCurve
from reports.data.report import Report
from reports.data.single_options import SingleOption
from scenarios.studies.work_precision import StepPoint
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.edges import BandEdge
from scenarios.sweeps.table import Point
from scenarios.sweeps.truths import Truths, truth_errors
from scenarios.tables import Column, csv_text, full_table, json_text, records
from scenarios.verdicts.finding import TRANSMITTANCE, Metric
from scenarios.verdicts.phase import PHASE
from scenarios.verdicts.truth_error import TrueTransmittance

NAME_COLUMNS: tuple[Column[Any], ...] = (
    Column("engine", lambda row: row.variant.engine),
    Column("formulation", lambda row: row.variant.formulation),
    Column("preset", lambda row: row.variant.preset_name),
)
LAW_NUMBERS = {
    "value": "value",
    "left": "difference",
    "allowed": "allowed",
    "distance": "distance",
    "period_bound": "period_bound",
}
"""What tables have of a prediction, by name: the law's number, the variant's less it, what both leave open of that, and
the distance of both after a period with its bound."""


def _predicted(metric: Metric | None, key: str, unit: str = "") -> Column[Point]:
    """Give the column of a number of the prediction of a metric, or of any; NaN where there is none."""

    def value(point: Point) -> float:
        predictions = (own.prediction for own in point.findings if metric in (None, own.metric))
        return next((getattr(one, LAW_NUMBERS[key]) for one in predictions if one is not None), math.nan)

    return Column(f"law_{key}{unit}", value)


BAND_EDGE_COLUMNS: tuple[Column[BandEdge], ...] = (
    Column("edge", lambda edge: str(edge.edge)),
    Column("frequency_ratio", lambda edge: math.nan if edge.frequency_ratio is None else edge.frequency_ratio),
    Column("difference", lambda edge: edge.comparison.difference),
    Column("verdict", lambda edge: str(edge.comparison.verdict)),
    Column("outcome", lambda edge: outcome((edge.finding,))),
    *(
        Column(f"law_{key}", lambda edge, name=name: getattr(edge.prediction, name, math.nan))  # type: ignore[misc]
        for key, name in LAW_NUMBERS.items()
    ),
    Column("reason", lambda edge: edge.comparison.reason),
)
POINT_COLUMNS: tuple[Column[Point], ...] = (Column("frequency_ratio", lambda point: point.frequency_ratio),)
TRANSMITTANCE_COLUMNS: tuple[Column[Point], ...] = (
    *POINT_COLUMNS,
    Column("status", lambda point: str(point.result.status)),
    Column("transmittance_db", lambda point: point.result.transmittance_db),
    Column("residual", lambda point: point.result.residual),
    Column("difference_db", lambda point: point.difference(TRANSMITTANCE)),
    Column("phase_rad", lambda point: point.result.phase),
    Column("difference_phase_deg", lambda point: point.difference(PHASE)),
    Column("verdict", lambda point: str(point.comparison.verdict)),
    Column("outcome", lambda point: outcome(point.findings)),
    *(_predicted(TRANSMITTANCE, key, "_db") for key in ("value", "left", "allowed")),
    *(_predicted(PHASE, key, "_phase_deg") for key in ("value", "left", "allowed")),
    *(_predicted(None, key) for key in ("distance", "period_bound")),
    Column("reason", lambda point: point.comparison.reason),
)

LEVEL = 3
"""Columns of a point up to its transmittance."""

ERROR_COLUMNS: tuple[Column[VariantErrors], ...] = (
    *NAME_COLUMNS,
    Column("worst_error_db", lambda own: own.worst.difference),
    Column("worst_frequency_ratio", lambda own: own.worst.frequency_ratio),
    Column("median_error_db", lambda own: own.median),
    Column("class", lambda own: "" if own.error_class is None else str(own.error_class)),
    Column("points_beyond_step", lambda own: own.beyond_step),
    Column("points_known", lambda own: own.known),
    Column("points", lambda own: own.points),
    Column("same_equations", lambda own: "yes" if own.shares_scheme else "no"),
    Column("difference_from_scheme_db", lambda own: own.from_scheme.difference),
)
WORST = 4
"""Columns up to the worst error, whose place follows."""

STEP_COLUMNS: tuple[Column[StepPoint], ...] = (
    *NAME_COLUMNS,
    Column("steps_per_period", lambda point: point.steps_per_period),
    Column("largest_error_db", lambda point: point.error_db),
    Column("step_s", lambda point: point.step_seconds),
    Column("steady_state_s", lambda point: point.seconds),
    Column("points_certified", lambda point: point.certified),
    Column("points_evaluated", lambda point: point.evaluated),
    Column("reason", lambda point: point.reason),
)


def _of_curve(result: ComparedSweep, columns: tuple[Column[Any], ...]) -> tuple[Column[Any], ...]:
    """Give the columns of a table: names of the variant and the values of its case come first."""
    axes = (Column(name, partial(_value, axis=name)) for name in result.sweep.case_axes)
    return (*NAME_COLUMNS, *axes, *columns)


def _value(row: BandEdge | Point, axis: str) -> float:
    return row.case.by_axis[axis]


def band_edge_table(result: ComparedSweep) -> pd.DataFrame:
    """Both edges of every curve; NaN where the grid does not hold the edge or nothing could be compared."""
    return full_table(_of_curve(result, BAND_EDGE_COLUMNS), result.edges)


def transmittance_table(result: ComparedSweep, truths: Truths) -> pd.DataFrame:
    """Every point of every curve, with the truth there."""
    errors = {point[:3]: error.error_db for point, error in truth_errors(result, truths, result.points)}
    unknown = TrueTransmittance(math.nan, math.nan, exact=False)

    def truth(point: Point) -> TrueTransmittance:
        return truths.get((point.case, point.frequency_ratio), unknown)

    columns: tuple[Column[Point], ...] = (
        Column("truth_db", lambda point: truth(point).transmittance_db),
        Column("truth_error_db", lambda point: truth(point).error_db),
        Column("error_db", lambda point: errors.get(point[:3], math.nan)),
    )
    before, after = TRANSMITTANCE_COLUMNS[:LEVEL], TRANSMITTANCE_COLUMNS[LEVEL:]
    return full_table(_of_curve(result, (*before, *columns, *after)), result.points)


def error_table(report: Report) -> pd.DataFrame:
    """Every variant against the truth, the smallest error first."""
    rows = list(report.errors.values())
    axes = report.result.sweep.case_axes
    places = (Column(f"worst_{name}", partial(_worst_value, axis=name)) for name in axes)
    return full_table((*ERROR_COLUMNS[:WORST], *places, *ERROR_COLUMNS[WORST:]), rows)


def _worst_value(own: VariantErrors, axis: str) -> float:
    return math.nan if own.worst.case is None else own.worst.case.by_axis[axis]


def catalogue_table(known: Outcomes) -> pd.DataFrame:
    """Numbers by outcome of every variant in every scenario that is known."""
    rows = [
        (scenario, *vars(variant).values(), *(counts.get(each, 0) for each in Outcome))
        for scenario, own in known.items()
        for variant, counts in own.items()
    ]
    return pd.DataFrame(rows, columns=["scenario", *(column.key for column in NAME_COLUMNS), *map(str, Outcome)])


def option_table(curves: Iterable[OptionCurve], singles: Iterable[SingleOption] = ()) -> pd.DataFrame:
    """Every variant of every curve over one option, and every default with one option of the tuned preset."""
    rows = [
        (*vars(own.errors.variant).values(), curve.option, own.value, own.errors.size, own.errors.median, own.creep)
        for curve in curves
        for own in curve.points
    ]
    rows += [
        (*vars(own.errors.variant).values(), own.option, own.value, own.errors.size, own.errors.median, math.nan)
        for own in singles
    ]
    names = ("option", "value", "largest_error_db", "median_error_db", "largest_creep")
    return pd.DataFrame(rows, columns=[*(column.key for column in NAME_COLUMNS), *names])


def transition_table(result: ComparedSweep) -> pd.DataFrame:
    """Every change of mode at every point of every curve that has a steady state."""
    columns = _of_curve(result, POINT_COLUMNS)
    rows = [
        (*(column.value(point) for column in columns), *transition)
        for point in result.points
        if point.result.converged
        for transition in point.result.transitions
    ]
    return pd.DataFrame(rows, columns=[*(column.key for column in columns), "cell", "time_s", "kind"])


def table_files(report: Report) -> dict[str, str]:
    """Give every table as CSV, and the numbers of all but the transitions as JSON, with where they come from."""
    result = report.result
    edges, points, errors = band_edge_table(result), transmittance_table(result, report.truths), error_table(report)
    content = {
        "provenance": report.provenance,
        "errors": records(errors),
        "summary": [_summary(own) for own in report.findings.values()],
        "failures": report.failures,
        "band_edges": records(edges),
        "stick_slip": report.stick_slip,
        "transmittance": records(points),
    }
    return {
        "errors.csv": csv_text(errors),
        "band_edges.csv": csv_text(edges),
        "transmittance.csv": csv_text(points),
        "transitions.csv": csv_text(transition_table(result)),
        "catalogue.csv": csv_text(catalogue_table(report.catalogue)),
        "options.csv": csv_text(option_table(report.option_curves, report.single_options)),
        "work_precision.csv": csv_text(full_table(STEP_COLUMNS, report.steps or ())),
        "report.json": json_text(content),
    }


def _summary(own: VariantFindings) -> dict[str, Any]:
    numbers = {name: value for name, value in vars(own).items() if name not in ("variant", "blocked")}
    return {**vars(own.variant), **numbers, "worst_edge": _extreme(own.worst_edge)}


def _extreme(extreme: Extreme) -> dict[str, Any]:
    case = {} if extreme.case is None else extreme.case.by_axis
    return {"difference": extreme.difference, **case, "frequency_ratio": extreme.frequency_ratio}
