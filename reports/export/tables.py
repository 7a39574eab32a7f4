"""Tables and the JSON file beside the page: the numbers in full."""

import math
from functools import partial
from typing import Any

import pandas as pd

from reports.data.departures import outcome
from reports.data.findings import Extreme, VariantFindings
from reports.data.report import Report
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.edges import BandEdge
from scenarios.sweeps.table import Point
from scenarios.tables import Column, csv_text, full_table, json_text, records
from scenarios.verdicts.finding import TRANSMITTANCE, Metric
from scenarios.verdicts.phase import PHASE

NAME_COLUMNS: tuple[Column[BandEdge | Point], ...] = (
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


def _of_curve(result: ComparedSweep, columns: tuple[Column[Any], ...]) -> tuple[Column[Any], ...]:
    """Give the columns of a table: names of the variant and the values of its case come first."""
    axes = (Column(name, partial(_value, axis=name)) for name in result.sweep.case_axes)
    return (*NAME_COLUMNS, *axes, *columns)


def _value(row: BandEdge | Point, axis: str) -> float:
    return row.case.by_axis[axis]


def band_edge_table(result: ComparedSweep) -> pd.DataFrame:
    """Both edges of every curve; NaN where the grid does not hold the edge or nothing could be compared."""
    return full_table(_of_curve(result, BAND_EDGE_COLUMNS), result.edges)


def transmittance_table(result: ComparedSweep) -> pd.DataFrame:
    """Every point of every curve."""
    return full_table(_of_curve(result, TRANSMITTANCE_COLUMNS), result.points)


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
    edges, points = band_edge_table(result), transmittance_table(result)
    content = {
        "provenance": report.provenance,
        "summary": [_summary(own) for own in report.findings.values()],
        "failures": report.failures,
        "band_edges": records(edges),
        "stick_slip": report.stick_slip,
        "transmittance": records(points),
    }
    return {
        "band_edges.csv": csv_text(edges),
        "transmittance.csv": csv_text(points),
        "transitions.csv": csv_text(transition_table(result)),
        "report.json": json_text(content),
    }


def _summary(own: VariantFindings) -> dict[str, Any]:
    numbers = {name: value for name, value in vars(own).items() if name not in ("variant", "blocked")}
    worst = {name: _extreme(numbers[name]) for name in ("worst_difference", "worst_edge")}
    return {**vars(own.variant), **numbers, **worst}


def _extreme(extreme: Extreme) -> dict[str, Any]:
    case = {} if extreme.case is None else extreme.case.by_axis
    return {"difference": extreme.difference, **case, "frequency_ratio": extreme.frequency_ratio}
