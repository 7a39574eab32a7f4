"""What each variant comes to, in one row of numbers: how far it is from the truth, its verdicts, what deviates."""

import math
from collections.abc import Iterable, Mapping
from typing import Any

import pandas as pd

from multibody_xval.engines.interface.law import NotModelled
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.data.points import UNMODELLED, by_variant, largest, names_of, rows_of
from multibody_xval.scenarios.runs.result import ResultStatus
from multibody_xval.scenarios.sweeps.truths import error_class
from multibody_xval.scenarios.verdicts.finding import FLOOR_DB, Verdict
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE

Errors = Mapping[Variant, Any]
"""Rows of an `error_table` by variant; their columns are attributes."""


def error_table(points: pd.DataFrame, axes: Iterable[str] = ()) -> pd.DataFrame:
    """Compare every variant of a table of points with the truth, the smallest error first; without any come last.

    Over all points at which the truth is above `FLOOR_DB`: how many there are, and how many have a steady state that
    can be compared; the largest error, with its sign, its size and its place; the median size; points farther from the
    truth than the scheme is with as many steps; and the largest difference from the reference at equal time step, which
    is agreement with the scheme, not with truth.
    """
    comparable = points[points["truth_db"] > FLOOR_DB]
    every = by_variant(comparable, dict.fromkeys(points["variant"]))
    rows = [{"variant": variant, **names_of(variant), **_errors(variant, own, axes)} for variant, own in every.items()]
    return pd.DataFrame(rows, dtype=object).sort_values("size", kind="stable", na_position="last")


def _errors(variant: Variant, points: pd.DataFrame, axes: Iterable[str]) -> dict[str, Any]:
    known = points[points["error_db"].notna()]
    worst = largest(known, "error_db")
    solves_the_scheme = variant.engine == REFERENCE.engine or variant.preset.shares_scheme
    return {
        "size": abs(worst["error_db"]),
        "worst_case": worst["case"],
        "worst_error_db": worst["error_db"],
        **{f"worst_{name}": math.nan if worst["case"] is None else worst["case"].by_axis[name] for name in axes},
        "worst_frequency_ratio": worst["frequency_ratio"],
        "median_error_db": float(known["error_db"].abs().median()),
        "error_class": str(error_class(known) or ""),
        "points_beyond_step": int((~(known["error_db"].abs() <= known["step_db"])).sum()),
        "points_known": len(known),
        "points": len(points),
        "blocked": bool((points["status"] == ResultStatus.BLOCKED).all()),
        "same_equations": "yes" if solves_the_scheme else "no",
        "difference_from_scheme_db": largest(known, "scheme_db")["scheme_db"],
    }


def errors_of(table: pd.DataFrame) -> Errors:
    """Give the rows of an `error_table`, by variant."""
    return {row.variant: row for row in rows_of(table)}


def verdict_row(points: pd.DataFrame, edges: pd.DataFrame) -> dict[str, Any]:
    """Sum up all points and edges of one variant on the grid.

    ``worst_edge`` is the largest difference of a band edge from that of what the variant is compared with; ``seconds``
    is the time of all points together, on one core, with those that did not converge and without refined edges.
    """
    converged = points[points["status"] == ResultStatus.CONVERGED]
    worst = largest(edges[edges["frequency_ratio"].notna()], "difference")
    counted = points["verdict"].value_counts()
    return {
        "verdicts": {str(verdict): int(counted.get(str(verdict), 0)) for verdict in Verdict},
        "worst_edge": {
            "difference": worst["difference"],
            **(worst["case"].by_axis if worst["case"] is not None else {}),
            "frequency_ratio": worst["frequency_ratio"],
        },
        "worst_residual": float(converged["residual"].max()),
        "median_periods": float(converged["periods"].median()),
        "seconds": float(points["seconds"].sum(min_count=1)),
    }


def deviations(variant: Variant, points: pd.DataFrame, edges: pd.DataFrame) -> dict[str, Any] | None:
    """Sum up what deviates of one variant, and what its law leaves of that [dB]; ``None`` where nothing does.

    ``worst`` is the largest deviation of transmittance with the prediction and what is left there, ``median`` the
    medians of their sizes over the points that deviate, ``largest_left`` the largest size of what is left.
    """
    own, own_edges = (table[table["outcome"] != ""] for table in (points, edges))
    if own.empty and own_edges.empty:
        return None
    sizes = pd.DataFrame({"deviation": own["difference_db"], "left": own["law_left_db"]})
    sizes.insert(1, "prediction", sizes["deviation"] - sizes["left"])
    ordered = sizes[sizes["deviation"].notna()].sort_values("deviation", key=abs, ascending=False, kind="stable")
    return {
        "variant": variant,
        "points": len(own),
        "edges": len(own_edges),
        "unmodelled": sum(int((table["outcome"] == UNMODELLED).sum()) for table in (own, own_edges)),
        "worst": ordered.iloc[0].to_dict() if len(ordered) else dict.fromkeys(sizes.columns, math.nan),
        "median": sizes.abs().median().to_dict(),
        "largest_left": float(sizes["left"].abs().max()),
        "note": _without_law(variant),
    }


def _without_law(variant: Variant) -> str:
    """Say why a variant has no prediction; empty where there is one."""
    if variant.law is not None:
        return ""
    stated = variant.preset.stated_law()
    return f"not modelled: {stated.reason}" if isinstance(stated, NotModelled) else "claims the reference's step"
