"""Tables and the JSON file beside the page: the numbers in full."""

import csv
import dataclasses
import io
import json
import math
from collections.abc import Iterable, Mapping
from typing import Any

from engines.interface.variant import Variant
from reports.data.findings import findings
from scenarios.studies.figure3 import Figure3Result

Row = dict[str, Any]

BAND_EDGE_COLUMNS = (
    "engine", "formulation", "preset", "friction_ratio", "edge", "frequency_ratio", "difference",
    "verdict", "reason",
)  # fmt: skip
TRANSMITTANCE_COLUMNS = (
    "engine", "formulation", "preset", "friction_ratio", "frequency_ratio", "transmittance_db", "residual",
    "difference_db", "verdict", "reason",
)  # fmt: skip
TRANSITION_COLUMNS = (
    "engine", "formulation", "preset", "friction_ratio", "frequency_ratio", "cell", "time_s", "kind",
)  # fmt: skip


def band_edge_rows(result: Figure3Result) -> list[Row]:
    """Both edges of every curve; ``nan`` where the grid does not hold the edge or nothing could be compared."""
    return [
        {
            **_names(edge.variant),
            "friction_ratio": edge.friction_ratio,
            "edge": str(edge.edge),
            "frequency_ratio": math.nan if edge.frequency_ratio is None else edge.frequency_ratio,
            "difference": edge.comparison.difference,
            "verdict": str(edge.comparison.verdict),
            "reason": edge.comparison.reason,
        }
        for edge in result.edges
    ]


def transmittance_rows(result: Figure3Result) -> list[Row]:
    """Every point of every curve."""
    return [
        {
            **_names(point.variant),
            "friction_ratio": point.friction_ratio,
            "frequency_ratio": point.frequency_ratio,
            "transmittance_db": point.answer.transmittance_db,
            "residual": point.answer.residual,
            "difference_db": point.comparison.difference,
            "verdict": str(point.comparison.verdict),
            "reason": point.comparison.reason,
        }
        for point in result.points
    ]


def transition_rows(result: Figure3Result) -> list[Row]:
    """Every change of mode at every point of every curve that has a steady state."""
    return [
        {
            **_names(point.variant),
            "friction_ratio": point.friction_ratio,
            "frequency_ratio": point.frequency_ratio,
            "cell": cell,
            "time_s": time,
            "kind": kind,
        }
        for point in result.points
        if point.answer.converged
        for cell, time, kind in point.answer.transitions
    ]


def csv_text(columns: tuple[str, ...], rows: Iterable[Row]) -> str:
    """Give rows as CSV, with numbers in full."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([row[name] for name in columns] for row in rows)
    return text.getvalue()


def json_text(result: Figure3Result, stick_slip: list[Row], provenance: Mapping[str, Any]) -> str:
    """Give the numbers of all tables but the transitions as JSON, with where they come from."""
    report = {
        "provenance": provenance,
        "summary": [_summary(result, variant) for variant in result.asked.all_variants],
        "band_edges": band_edge_rows(result),
        "stick_slip": stick_slip,
        "transmittance": transmittance_rows(result),
    }
    return json.dumps(_plain(report), ensure_ascii=False, allow_nan=False) + "\n"


def _names(variant: Variant) -> Row:
    return {"engine": variant.engine, "formulation": variant.formulation, "preset": variant.preset_name}


def _summary(result: Figure3Result, variant: Variant) -> Row:
    found = dataclasses.asdict(findings(result, variant))
    return {**found.pop("variant"), **found}


def _plain(value: Any) -> Any:
    """Turn everything into what JSON holds: NaN and infinities into null, strange options into their text."""
    if isinstance(value, Mapping):
        return {str(name): _plain(one) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if value is None or isinstance(value, bool | int | str) else repr(value)
