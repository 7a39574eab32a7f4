"""Tables of a report: a row a point, a row an edge, with scalars; what it shows of variants are group-bys of them."""

import math
from collections.abc import Iterable, Sequence
from typing import Any

import pandas as pd

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.sweeps.attenuation_band import Edge
from multibody_xval.scenarios.sweeps.compared import ComparedSweep
from multibody_xval.scenarios.sweeps.edges import BandEdge
from multibody_xval.scenarios.sweeps.point import Point
from multibody_xval.scenarios.sweeps.truths import truth_error
from multibody_xval.scenarios.verdicts.finding import FLOOR_DB, PHASE, TRANSMITTANCE, Finding, Prediction, unmodelled
from multibody_xval.scenarios.verdicts.judge import metric_difference
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED

MODELLED, UNMODELLED = "modelled", "unmodelled"
"""Outcomes of a point or an edge that deviates from what it is compared with."""

NAMES = ("engine", "formulation", "preset")
"""Of a variant, in the order of `names_of`."""

POINT_COLUMNS = (
    "frequency_ratio", "status", "transmittance_db", "truth_db", "truth_error_db", "error_db", "residual",
    "difference_db", "phase_rad", "difference_phase_deg", "verdict", "outcome", "law_value_db", "law_left_db",
    "law_allowed_db", "law_value_phase_deg", "law_left_phase_deg", "law_allowed_phase_deg", "law_distance",
    "law_period_bound", "reason",
)  # fmt: skip
"""Columns of a point that are written, after the names of its variant and the values of its case."""

MORE_COLUMNS = (
    "part", "variant", "case", "truth_exact", "step_db", "scheme_db", "baseline_db", "periods", "steps_per_period",
    "seconds", "creep",
)  # fmt: skip
"""Columns that the page needs beside them: what the truth leaves open of an error, the differences from the reference
at equal time step and from the converged one, and the largest slip velocity within a stick over ω U0."""

EDGE_COLUMNS = (
    "edge", "frequency_ratio", "difference", "verdict", "outcome", "law_value", "law_left", "law_allowed",
    "law_distance", "law_period_bound", "reason",
)  # fmt: skip


def outcome(findings: Sequence[Finding]) -> str:
    """Say whether what deviates is as the law predicts; empty where nothing deviates."""
    if unmodelled(findings):
        return UNMODELLED
    return MODELLED if any(finding.modelled for finding in findings) else ""


def names_of(variant: Variant) -> dict[str, str]:
    """Give the names of a variant, as tables have them."""
    return dict(zip(NAMES, (variant.engine, variant.formulation, variant.preset_name), strict=True))


def written(table: pd.DataFrame, result: ComparedSweep, columns: Iterable[str]) -> pd.DataFrame:
    """Give the columns of a table that are written: names of the variant and the values of its case come first."""
    return table[[*NAMES, *result.sweep.case_axes, *columns]]


def point_table(result: ComparedSweep, **others: Sequence[Point]) -> pd.DataFrame:
    """Give a row for each point of the grid, and of `others` by their part; NaN where a number is not known.

    The column ``part`` says of which: ``grid``, or the name of the others.
    """
    whole = CONVERGED in result.sweep.variants
    rows = [
        {"part": part, **_row(point, point.converged if whole else point.reference)}
        for part, points in {"grid": result.points, **others}.items()
        for point in points
    ]
    return pd.DataFrame(rows, columns=[*MORE_COLUMNS, *NAMES, *result.sweep.case_axes, *POINT_COLUMNS])


def _row(point: Point, baseline: Result) -> dict[str, Any]:
    own, level, truth = point.result, point.result.transmittance_db, point.truth
    error_db, step_db = truth_error(point)
    creeps = [creep for creep in own.creep if own.converged and not math.isnan(creep)]
    certified = own.converged and baseline.converged and baseline.transmittance_db > FLOOR_DB
    return {
        **_labels(point),
        "frequency_ratio": point.frequency_ratio,
        "status": str(own.status),
        "transmittance_db": level,
        "truth_db": truth.transmittance_db,
        "truth_error_db": truth.error_db,
        "truth_exact": truth.exact,
        "error_db": error_db,
        "step_db": step_db,
        "scheme_db": metric_difference(TRANSMITTANCE, level, point.reference.transmittance_db),
        "baseline_db": level - baseline.transmittance_db if certified else math.nan,
        "residual": own.residual,
        "periods": own.periods,
        "steps_per_period": own.steps_per_period,
        "seconds": own.seconds,
        "creep": max(creeps, default=math.nan),
        "difference_db": point.difference(TRANSMITTANCE),
        "phase_rad": own.phase,
        "difference_phase_deg": point.difference(PHASE),
        **({"verdict": str(point.comparison.verdict), "reason": point.comparison.reason} if point.findings else {}),
        "outcome": outcome(point.findings),
        **_law(point.prediction(TRANSMITTANCE), "_db"),
        **_law(point.prediction(PHASE), "_phase_deg"),
        **_motion(point.prediction(TRANSMITTANCE, PHASE)),
    }


def _labels(row: Point | BandEdge) -> dict[str, Any]:
    return {"variant": row.variant, "case": row.case, **names_of(row.variant), **row.case.by_axis}


def _law(prediction: Prediction | None, unit: str = "") -> dict[str, float]:
    """Give the law's number, the variant's less it, and what both leave open of that; NaN without a prediction."""
    numbers = {"value": "value", "left": "difference", "allowed": "allowed"}
    return {f"law_{key}{unit}": getattr(prediction, name, math.nan) for key, name in numbers.items()}


def _motion(prediction: Prediction | None) -> dict[str, float]:
    """Give the distance of the variant and of its law after a period, over U0, with its bound; likewise."""
    return {f"law_{name}": getattr(prediction, name, math.nan) for name in ("distance", "period_bound")}


def edge_table(result: ComparedSweep) -> pd.DataFrame:
    """Give both edges of every curve; NaN where the grid does not hold the edge or nothing could be compared."""
    rows = [
        {
            **_labels(edge),
            "edge": str(edge.edge),
            "frequency_ratio": math.nan if edge.frequency_ratio is None else edge.frequency_ratio,
            "absent": absent_edge(result, edge) if edge.frequency_ratio is None else "",
            "difference": edge.comparison.difference,
            "allowed": edge.comparison.tolerance,
            "verdict": str(edge.comparison.verdict),
            "outcome": outcome((edge.finding,)),
            **_law(edge.prediction),
            **_motion(edge.prediction),
            "reason": edge.comparison.reason,
        }
        for edge in result.edges
    ]
    more = ("variant", "case", "absent", "allowed")
    return pd.DataFrame(rows, columns=[*more, *NAMES, *result.sweep.case_axes, *EDGE_COLUMNS])


def absent_edge(result: ComparedSweep, edge: BandEdge) -> str:
    """Describe an edge that the grid does not hold."""
    curve = [point for point in result.curve(edge.variant, edge.case) if point.result.converged]
    if not curve:
        return "unknown"
    if all(point.result.transmittance_db >= result.sweep.band.depth_db for point in curve):
        return "none"
    if edge.edge is Edge.LOWER:
        return f"below {curve[0].frequency_ratio:g}"
    return f"above {curve[-1].frequency_ratio:g}"


def transition_table(result: ComparedSweep) -> pd.DataFrame:
    """Give every change of mode at every point of every curve that has a steady state."""
    rows = [
        (*names_of(point.variant).values(), *point.case.by_axis.values(), point.frequency_ratio, *transition)
        for point in result.points
        if point.result.converged
        for transition in point.result.transitions
    ]
    columns = (*NAMES, *result.sweep.case_axes, "frequency_ratio", "cell", "time_s", "kind")
    return pd.DataFrame(rows, columns=columns)


def rows_of(table: pd.DataFrame) -> list[Any]:
    """Give the rows of a table; their columns are attributes."""
    return list(table.itertuples(index=False))


def by_variant(table: pd.DataFrame, variants: Iterable[Variant] | None = None) -> dict[Variant, pd.DataFrame]:
    """Give the rows of each of these variants, of every one that a table has without them."""
    groups: dict[Any, pd.DataFrame] = dict(iter(table.groupby("variant", sort=False)))
    return groups if variants is None else {variant: groups.get(variant, table.iloc[:0]) for variant in variants}


def largest(table: pd.DataFrame, column: str) -> dict[str, Any]:
    """Give the row with the largest size in a column, the first of equal ones; NaN in it where there is none."""
    sizes = table[column].astype(float).abs()
    if sizes.isna().all():
        return {column: math.nan, "case": None, "frequency_ratio": math.nan}
    return {str(name): value for name, value in table.iloc[int(sizes.argmax())].items()}
