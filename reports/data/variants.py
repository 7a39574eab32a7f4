"""What each variant comes to, in one row of numbers: how far it is from the truth, its verdicts, what departs."""

import math
from dataclasses import dataclass
from typing import Any

import pandas as pd

from engines.interface.law import NotModelled
from engines.interface.variant import Variant
from reports.data.points import UNEXPLAINED, by_variant, largest
from scenarios.runs.result import ResultStatus
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.sweep import Case
from scenarios.sweeps.truths import ErrorClass, error_class
from scenarios.verdicts.finding import FLOOR_DB, Verdict
from scenarios.verdicts.steady_case import REFERENCE


@dataclass(frozen=True)
class VariantErrors:
    """One variant against the truth, over all points at which this is above `FLOOR_DB`."""

    variant: Variant
    known: int = 0
    points: int = 0
    """Points with a steady state that can be compared, of how many."""
    worst_db: float = math.nan
    """The largest error, with its sign."""
    worst_case: Case | None = None
    worst_frequency_ratio: float = math.nan
    median_db: float = math.nan
    """Of the sizes of errors."""
    beyond_step: int = 0
    """Points at which the variant is farther from the truth than the scheme is with as many steps."""
    from_scheme_db: float = math.nan
    """The largest difference from the reference at equal time step: agreement with the scheme, not with truth."""
    error_class: ErrorClass | None = None

    @property
    def size(self) -> float:
        """Size of the largest error [dB]."""
        return abs(self.worst_db)

    @property
    def shares_scheme(self) -> bool:
        """Whether it solves the equations of the reference's scheme; the converged reference does, with finer steps."""
        return self.variant.engine == REFERENCE.engine or self.variant.preset.shares_scheme


def variant_errors(points: pd.DataFrame) -> dict[Variant, VariantErrors]:
    """Compare every variant of a table of points with the truth, the smallest error first; without any come last."""
    every = [_errors(variant, own[own["truth_db"] > FLOOR_DB]) for variant, own in by_variant(points).items()]
    return {own.variant: own for own in sorted(every, key=lambda own: math.inf if math.isnan(own.size) else own.size)}


def _errors(variant: Variant, points: pd.DataFrame) -> VariantErrors:
    known = points[points["error_db"].notna()]
    worst = largest(known, "error_db")
    return VariantErrors(
        variant=variant,
        known=len(known),
        points=len(points),
        worst_db=worst["error_db"],
        worst_case=worst["case"],
        worst_frequency_ratio=worst["frequency_ratio"],
        median_db=float(known["error_db"].abs().median()),
        beyond_step=int((~(known["error_db"].abs() <= known["step_db"])).sum()),
        from_scheme_db=largest(known, "scheme_db")["scheme_db"],
        error_class=error_class(known),
    )


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


def blocked_reason(result: ComparedSweep, variant: Variant) -> str | None:
    """Give the reason why a variant has no result at all; ``None`` if it has one."""
    results = [point.result for point in result.points_of(variant)]
    if not results or any(own.status is not ResultStatus.BLOCKED for own in results):
        return None
    return results[0].reason


def departures(variant: Variant, points: pd.DataFrame, edges: pd.DataFrame) -> dict[str, Any] | None:
    """Sum up what departs of one variant, and what its law leaves of that [dB]; ``None`` where nothing does.

    ``worst`` is the largest departure of transmittance with the prediction and what is left there, ``median`` the
    medians of their sizes over the points that depart, ``largest_left`` the largest size of what is left.
    """
    own, own_edges = (table[table["outcome"] != ""] for table in (points, edges))
    if own.empty and own_edges.empty:
        return None
    sizes = pd.DataFrame({"departure": own["difference_db"], "left": own["law_left_db"]})
    sizes.insert(1, "prediction", sizes["departure"] - sizes["left"])
    ordered = sizes[sizes["departure"].notna()].sort_values("departure", key=abs, ascending=False, kind="stable")
    return {
        "variant": variant,
        "points": len(own),
        "edges": len(own_edges),
        "unexplained": sum(int((table["outcome"] == UNEXPLAINED).sum()) for table in (own, own_edges)),
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
