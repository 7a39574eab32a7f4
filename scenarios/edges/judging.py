"""Edges beside those of the exact motion, or of the reference for presets that share its scheme."""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from multibody_xval.scenarios.edges.exact_place import exact_levels, exact_place
from multibody_xval.scenarios.edges.finding import edges, refined
from multibody_xval.scenarios.result_tables import CONFIG, CURVE, is_reference
from multibody_xval.scenarios.ruler.exact_values import MARGIN
from multibody_xval.scenarios.ruler.judge import (
    AGREES,
    COARSE_SHARE,
    DB,
    DEVIATES,
    TOO_LARGE,
    UNKNOWN,
    friction_effect,
    judged,
    resolution,
)

NOT_REFINED = "not refined"
"""Verdict on an edge whose bracket is still too wide."""

CURVE_OF = [name for name in CURVE if name != "steps"]

RULED = dict.fromkeys(
    ["exact", "exact_bar", "scheme", "reference", "reference_open", "ruled_slope", "growth", "effect"], float
)
"""What is known of an edge of the reference."""

HELPERS = ("reference_open", "ruled_slope", "growth", "effect", "deviates", "of_reference")
"""Columns that only verdicts need."""


@np.errstate(invalid="ignore", divide="ignore")
def judged_edges(table: pd.DataFrame) -> pd.DataFrame:
    """Compare edges of curves with those of the exact motion, or of the reference for presets that share its scheme.

    What is allowed of an amplitude there is allowed of an edge, over the slope; to that comes how far off each may be
    by its points. Where an edge is absent in one of two curves alone, it deviates if a point of the curve does; points
    without a steady state leave it unknown.

    Returns
    -------
    DataFrame
        The columns of `edges`, those of a configuration that its judgement needs, and in η_r: ``exact``, its
        ``exact_bar`` and the ``error`` from it; ``reference``; ``expected``: one of the two; ``allowed``; ``verdict``.
    """
    table = table.reset_index(drop=True)
    points = judged(table)
    found = edges(table)
    of_reference = found[is_reference(found)].drop_duplicates(["curve", "steps", "edge"], keep="last")
    rows = found.merge(_ruled(of_reference, table, points), on=["curve", "steps", "edge"], how="left")
    rows = rows.merge(_of_curves(table, points), on=CURVE_OF, how="left")
    presence = of_reference[["curve", "steps", "edge"]].assign(of_reference=_presence(of_reference))
    rows = rows.merge(presence, on=["curve", "steps", "edge"], how="left")
    per_amplitude = DB / rows.ruled_slope.abs()
    blur = _open(rows, table) * per_amplitude + rows.interpolation
    step = np.maximum(rows.scheme, rows.accuracy * per_amplitude)
    shares = rows.shares_scheme
    allowed = (rows.exact_bar + step + blur).where(~shares, blur + rows.reference_open)
    rows = rows.assign(
        error=rows.frequency_ratio - rows.exact, expected=rows.reference.where(shares, rows.exact), allowed=allowed
    )
    rows = rows.assign(verdict=_verdicts(rows, allowed / per_amplitude)).drop(columns=[*HELPERS])
    return rows.astype(dict.fromkeys([*CONFIG, "version", "edge", "verdict"], str))


def _verdicts(rows: pd.DataFrame, amplitude: pd.Series) -> np.ndarray:
    """Say of each edge what it is; `amplitude` is what is allowed there."""
    own, other = _presence(rows), rows.of_reference
    absent = rows.before < 0
    one_alone = (absent & (other == "there")) | ((own == "there") & (other == "absent"))
    distance = (rows.frequency_ratio - rows.expected).abs()
    return np.select(
        [
            (own == "lost") | (other == "lost"),
            absent & (other == "absent"),
            one_alone & rows.deviates,
            absent | one_alone,
            ~refined(rows),
            distance.isna() | rows.allowed.isna(),
            distance > rows.allowed,
            amplitude > COARSE_SHARE * rows.effect,
        ],
        [UNKNOWN, AGREES, DEVIATES, UNKNOWN, NOT_REFINED, UNKNOWN, DEVIATES, TOO_LARGE],
        AGREES,
    )


def _of_curves(table: pd.DataFrame, points: pd.DataFrame) -> pd.DataFrame:
    """Give, of every curve, what its judgement needs of its configuration, and whether any of its points deviates."""
    own = table.groupby(CURVE_OF, sort=False, dropna=False)[["shares_scheme", "judged", "accuracy"]].first()
    off = (points.verdict == DEVIATES).groupby([points[name] for name in CURVE_OF], sort=False, dropna=False).any()
    own = own.astype({"shares_scheme": bool, "judged": bool, "accuracy": float})
    return own.assign(deviates=off.reindex(own.index, fill_value=False).astype(bool)).reset_index()


def _presence(found: pd.DataFrame) -> np.ndarray:
    """Say of each edge whether it is there or absent, or lost among points without a steady state."""
    return np.select([found.lost > 0, found.before < 0], ["lost", "absent"], "there")


def _open(rows: pd.DataFrame, table: pd.DataFrame) -> pd.Series:
    """Give what residual, round-off and contacts that give way leave open of the amplitudes beside each edge."""
    first, last = (
        resolution(table.reindex(rows[side]).set_index(rows.index).assign(growth=rows.growth)).astype(float)
        for side in ("before", "after")
    )
    return pd.concat([first, last], axis=1).max(axis=1, skipna=False)


def _ruled(reference: pd.DataFrame, table: pd.DataFrame, points: pd.DataFrame) -> pd.DataFrame:
    """Give, of every refined edge of the reference, the exact motion's, and what is known of amplitudes there."""
    levels = exact_levels(table)
    own_points = points[is_reference(points)]
    of_run = dict(zip(zip(own_points.case, own_points.steps, strict=True), own_points.index, strict=True))
    edge_rows: Iterable[Any] = reference[refined(reference)].itertuples()
    rows = []
    for own in edge_rows:
        place, step, exact_slope = exact_place(own, levels)
        case = replace(own.curve, frequency_ratio=place)
        at: Any = points.loc[of_run[run]] if (run := (case, case.steps(own.steps))) in of_run else None
        slope = min(abs(own.slope), abs(exact_slope))
        beside = table.loc[[own.before, own.after]]
        growth = beside.amplification.max()
        repeats = beside.residual.max() * MARGIN * growth * DB / slope
        bar, scheme, effect = np.nan, np.nan, np.nan
        if at is not None and not np.isnan(step):
            bar = at.exact_bar * DB / slope + abs(step)
            scheme = max(at.scheme_error * DB / slope, abs(own.frequency_ratio - place - step))
            effect = friction_effect(case, at.exact)
        found = (place + step, bar, scheme, own.frequency_ratio, own.interpolation + repeats, slope, growth, effect)
        rows.append((own.curve, own.steps, own.edge, *found))
    return pd.DataFrame(rows, columns=["curve", "steps", "edge", *RULED]).astype({"steps": int, "edge": str, **RULED})
