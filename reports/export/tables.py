"""Tables and the JSON file beside the page: the numbers in full."""

import pandas as pd

from multibody_xval.reports.data.catalogue import Outcome, Outcomes
from multibody_xval.reports.data.points import EDGE_COLUMNS, NAMES, POINT_COLUMNS, names_of, transition_table, written
from multibody_xval.reports.data.report import Report
from multibody_xval.scenarios.studies.work_precision import STEP_COLUMNS
from multibody_xval.scenarios.tables import csv_text, full_table, json_text, records

HEADLINE_COLUMNS = (
    "frequency_ratio", "steps_per_period", "status", "transmittance_db", "truth_db", "truth_error_db", "error_db",
    "residual",
)  # fmt: skip
"""Columns of the points from which ``errors.csv`` is made."""


def catalogue_table(known: Outcomes) -> pd.DataFrame:
    """Numbers by outcome of every variant in every scenario that is known."""
    rows = [
        (scenario, *names_of(variant).values(), *(counts.get(each, 0) for each in Outcome))
        for scenario, own in known.items()
        for variant, counts in own.items()
    ]
    return pd.DataFrame(rows, columns=["scenario", *NAMES, *map(str, Outcome)])


def table_files(report: Report) -> dict[str, str]:
    """Give every table as CSV, and the numbers of all but the transitions as JSON, with where they come from."""
    result = report.result
    points, edges = written(report.points, result, POINT_COLUMNS), written(report.edges, result, EDGE_COLUMNS)
    headline = written(report.ruled, result, HEADLINE_COLUMNS)
    left_out = ["variant", "size", "worst_case", "blocked"]
    errors = report.error_table.drop(columns=left_out).rename(columns={"error_class": "class"})
    content = {
        "provenance": report.provenance,
        "errors": records(errors),
        "summary": [{**names_of(variant), **row} for variant, row in report.verdicts.items()],
        "failures": report.failures,
        "band_edges": records(edges),
        "stick_slip": report.stick_slip,
        "transmittance": records(points),
    }
    return {
        "errors.csv": csv_text(errors),
        "headline.csv": csv_text(headline),
        "band_edges.csv": csv_text(edges),
        "transmittance.csv": csv_text(points),
        "transitions.csv": csv_text(transition_table(result)),
        "catalogue.csv": csv_text(catalogue_table(report.catalogue)),
        "work_precision.csv": csv_text(full_table(STEP_COLUMNS, report.steps or ())),
        "report.json": json_text(content),
    }
