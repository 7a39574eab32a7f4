"""Tables and the JSON file beside the page: the numbers in full."""

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

import pandas as pd

from engines.interface.variant import Variant
from reports.data.findings import findings
from scenarios.studies.figure3 import BandEdge, Figure3Result, Point
from scenarios.tables import Column, full_table, json_text, records

BAND_EDGE_COLUMNS: tuple[Column[BandEdge], ...] = (
    Column("engine", lambda edge: edge.variant.engine),
    Column("formulation", lambda edge: edge.variant.formulation),
    Column("preset", lambda edge: edge.variant.preset_name),
    Column("friction_ratio", lambda edge: edge.friction_ratio),
    Column("edge", lambda edge: str(edge.edge)),
    Column("frequency_ratio", lambda edge: math.nan if edge.frequency_ratio is None else edge.frequency_ratio),
    Column("difference", lambda edge: edge.comparison.difference),
    Column("verdict", lambda edge: str(edge.comparison.verdict)),
    Column("reason", lambda edge: edge.comparison.reason),
)
PLACE_COLUMNS: tuple[Column[Point], ...] = (
    Column("engine", lambda point: point.variant.engine),
    Column("formulation", lambda point: point.variant.formulation),
    Column("preset", lambda point: point.variant.preset_name),
    Column("friction_ratio", lambda point: point.friction_ratio),
    Column("frequency_ratio", lambda point: point.frequency_ratio),
)
TRANSMITTANCE_COLUMNS: tuple[Column[Point], ...] = (
    *PLACE_COLUMNS,
    Column("transmittance_db", lambda point: point.answer.transmittance_db),
    Column("residual", lambda point: point.answer.residual),
    Column("difference_db", lambda point: point.comparison.difference),
    Column("verdict", lambda point: str(point.comparison.verdict)),
    Column("reason", lambda point: point.comparison.reason),
)


def band_edge_table(result: Figure3Result) -> pd.DataFrame:
    """Both edges of every curve; NaN where the grid does not hold the edge or nothing could be compared."""
    return full_table(BAND_EDGE_COLUMNS, result.edges)


def transmittance_table(result: Figure3Result) -> pd.DataFrame:
    """Every point of every curve."""
    return full_table(TRANSMITTANCE_COLUMNS, result.points)


def transition_table(result: Figure3Result) -> pd.DataFrame:
    """Every change of mode at every point of every curve that has a steady state."""
    rows = [
        (*(column.value(point) for column in PLACE_COLUMNS), *transition)
        for point in result.points
        if point.answer.converged
        for transition in point.answer.transitions
    ]
    return pd.DataFrame(rows, columns=[*(column.key for column in PLACE_COLUMNS), "cell", "time_s", "kind"])


def report_json(result: Figure3Result, stick_slip: list[dict[str, Any]], provenance: Mapping[str, Any]) -> str:
    """Give the numbers of all tables but the transitions as JSON, with where they come from."""
    return json_text(
        {
            "provenance": provenance,
            "summary": [_summary(result, variant) for variant in result.asked.all_variants],
            "band_edges": records(band_edge_table(result)),
            "stick_slip": stick_slip,
            "transmittance": records(transmittance_table(result)),
        }
    )


def _summary(result: Figure3Result, variant: Variant) -> dict[str, Any]:
    found = dataclasses.asdict(findings(result, variant))
    return {**found.pop("variant"), **found}
