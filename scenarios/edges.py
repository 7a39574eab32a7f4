"""Edges of the attenuation band: refined by runs of each curve's own configuration, compared with the exact motion's.

The band holds the first deep attenuation of a curve, and extends to where the curve crosses the threshold. Ripple in
the pass band dips below the threshold too, but not as deep.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from multibody_xval.scenarios.exact_values import ruler
from multibody_xval.scenarios.judge import DB, judged, resolution
from multibody_xval.scenarios.model import Case, Run
from multibody_xval.scenarios.result_tables import CURVE, is_exact, is_reference

THRESHOLD_DB, DEPTH_DB = 0.0, -10.0
"""Transmittance at the edges, and below which an attenuation is deep."""

WIDTH, CLOSE = 5e-4, 1e-6
"""Of the bracket of a refined edge, and how close a cubic and a straight line through its ends cross the threshold,
both in η_r: a step of 400 per period moves edges by fifty times as much."""

KINK = 0.005
"""Part of its bracket by which an edge may be beside a straight line: slopes of the scheme change by 2 % within a
hundred-thousandth of η_r, wherever a transition passes on to the next step."""

NEAR = 1e-4
"""Distance in η_r from the reference's edge at which other curves are first tried: most have theirs there."""

RESOLVED_SPACING, CLOSE_DB = 0.0125, 3.0
"""A curve that runs this close below the threshold is resolved to this spacing: a crossing may hide there."""

FLAT = np.finfo(float).tiny
"""Keeps slopes of curves that do not move from dividing by zero."""


class Edge(NamedTuple):
    """One edge of one curve, as far as it is refined."""

    curve: tuple[object, ...]
    edge: str
    frequency_ratio: float
    width: float
    interpolation: float
    slope: float
    row: int


def curves(table: pd.DataFrame) -> Iterator[tuple[tuple[object, ...], pd.DataFrame]]:
    """Give the steady points of every curve by ascending frequency, without steps finer than those compared."""
    table = table[~is_exact(table)]
    coarsest = table.groupby([table.config, table.case], sort=False).steps.transform("min")
    steady = table[(table.steps == coarsest) & (table.status == "periodic")]
    for key, own in steady.groupby(CURVE, sort=False):
        yield key, own.sort_values("frequency_ratio").drop_duplicates("frequency_ratio")


def brackets(level_db: NDArray[np.float64]) -> dict[str, int]:
    """Give the row before each edge that a curve holds."""
    deep, above = np.flatnonzero(level_db < DEPTH_DB), np.flatnonzero(level_db >= THRESHOLD_DB)
    if not deep.size:
        return {}
    before, after = above[above < deep[0]], above[above > deep[0]]
    return {name: int(rows[0]) for name, rows in (("lower", before[-1:]), ("upper", after[:1] - 1)) if rows.size}


def edges(table: pd.DataFrame) -> pd.DataFrame:
    """Give the edges of every curve that its points hold.

    Columns: those of `CURVE`, ``edge`` (lower or upper), ``frequency_ratio``, ``width`` of its bracket,
    ``interpolation`` (the distance of a cubic from a straight line there), all in η_r, ``slope`` [dB per η_r], ``row``.
    """
    found = [own for key, curve in curves(table) for own in _edges_of(key, curve)]
    rows = [(*own.curve, *own[1:]) for own in found]
    return pd.DataFrame(rows, columns=[*CURVE, *Edge._fields[1:]])


def _edges_of(key: tuple[object, ...], curve: pd.DataFrame) -> Iterator[Edge]:
    eta, level = (curve[name].to_numpy() for name in ("frequency_ratio", "transmittance_db"))
    level = level - THRESHOLD_DB
    for name, row in brackets(level + THRESHOLD_DB).items():
        width = float(eta[row + 1] - eta[row])
        slope = float(level[row + 1] - level[row]) / width
        straight = eta[row] - level[row] / (slope or FLAT)
        near = slice(max(row - 1, 0), row + 3)
        roots = PchipInterpolator(eta[near], level[near]).solve(extrapolate=False)
        inside = roots[(roots >= eta[row]) & (roots <= eta[row + 1])]
        place = float(inside[0] if inside.size else straight)
        yield Edge(key, name, place, width, abs(place - float(straight)), slope, int(curve.index[row]))


def hidden(curve: pd.DataFrame) -> list[float]:
    """Give the frequencies that a curve still needs between its lower edge and its depth, to hide no crossing."""
    eta, level = (curve[name].to_numpy() for name in ("frequency_ratio", "transmittance_db"))
    row = brackets(level).get("lower")
    if row is None:
        return []
    inside = slice(row, int(np.argmax(level < DEPTH_DB)) + 1)
    left, right = eta[inside][:-1], eta[inside][1:]
    close = np.maximum(level[inside][:-1], level[inside][1:]) > THRESHOLD_DB - CLOSE_DB
    wide = right - left > RESOLVED_SPACING * (1 + 1e-9)
    return np.round((left + right)[close & wide] / 2, 6).tolist()


def propose(table: pd.DataFrame) -> list[Run]:
    """Give the runs that edges need next; none where they are refined.

    First what hides no crossing; then two points on either side of each edge, the reference's first, which the others
    then begin at; with those, the ruler at the reference's edges.
    """
    known = {Run(*own) for own in zip(table.config, table.case, table.steps, strict=True)}
    new = [_run_at(curve.iloc[0], eta) for _, curve in curves(table) for eta in hidden(curve)]
    if new := [run for run in new if run not in known]:
        return new
    found = edges(table)
    if found.empty:
        return []
    reference, wide = is_reference(found), ~refined(found)
    runs: list[Run] = []
    if (reference & wide).any():
        runs = [run for own in found[reference & wide].itertuples() for run in _around(own, table)]
    else:
        starts = found[reference].set_index(["curve", "steps", "edge"]).frequency_ratio.to_dict()
        for own in found[wide].itertuples():
            runs += _beside(own, table, starts, known) or _around(own, table)
        runs += [run for own in found[reference].itertuples() for run in ruler([(ruled_case(own), own.steps)])]
    return [run for run in dict.fromkeys(runs) if run not in known]


def refined(found: pd.DataFrame) -> pd.Series:
    """Tell which edges need no more runs."""
    return (found.width <= WIDTH) & (found.interpolation <= CLOSE)


def _around(own: Any, table: pd.DataFrame) -> list[Run]:
    """Give two runs on either side of where a curve's own points expect an edge."""
    aside = max(own.width / 20, CLOSE)
    return [_run_at(table.loc[own.row], round(own.frequency_ratio + side, 9)) for side in (-aside, aside)]


def _beside(own: Any, table: pd.DataFrame, starts: dict[Any, float], known: set[Run]) -> list[Run]:
    """Give two runs on either side of the reference's edge, unless they are known."""
    place = starts.get((own.curve, own.steps, own.edge))
    if place is None or own.width <= WIDTH or abs(place - own.frequency_ratio) > own.width:
        return []
    runs = [_run_at(table.loc[own.row], round(place + side, 9)) for side in (-NEAR, NEAR)]
    return [run for run in runs if run not in known]


def _run_at(row: pd.Series, frequency_ratio: float) -> Run:
    """Give the run of a row's curve at another frequency."""
    return Run(row.config, replace(row.case, frequency_ratio=frequency_ratio), int(row.steps))


def ruled_case(own: pd.Series) -> Case:
    """Give the case at an edge of the reference at which the exact motion is computed."""
    return replace(own.curve, frequency_ratio=round(own.frequency_ratio, 6))


AGREES, DEVIATES, NOT_REFINED, NONE, UNKNOWN = "agrees", "deviates", "not refined", "no such edge", "unknown"
"""What an edge is."""


def judged_edges(table: pd.DataFrame) -> pd.DataFrame:
    """Compare edges of curves with those of the exact motion, or of the reference for presets that share its scheme.

    The exact motion's edge is as far from the reference's as its level there is from the threshold, over the slope;
    what is allowed of an amplitude, over the slope, is allowed of an edge.

    Added columns: ``exact`` and ``exact_bar``, ``error`` from that, ``expected``, ``allowed``, ``verdict``; in η_r.
    """
    found = edges(table)
    points = judged(table)
    places = _exact_edges(found[is_reference(found)], points)
    rows = found.merge(places, on=["curve", "steps", "edge"], how="left")
    rows = rows.merge(_allowances(points), on=CURVE, how="left").assign(error=rows.frequency_ratio - rows.exact)
    step = np.maximum(rows.scheme, rows.accuracy * DB / rows.slope.abs())
    blur = rows.open * DB / rows.slope.abs() + rows.interpolation + KINK * rows.width + rows.reference_bar
    allowed = (rows.exact_bar + step + blur).where(~rows.shares_scheme, blur)
    expected = rows.exact.where(~rows.shares_scheme, rows.reference)
    distance = (rows.frequency_ratio - expected).abs()
    verdict = np.select(
        [~refined(rows), distance.isna() | allowed.isna(), distance <= allowed],
        [NOT_REFINED, UNKNOWN, AGREES],
        DEVIATES,
    )
    return rows.assign(expected=expected, allowed=allowed, verdict=verdict)


def _allowances(points: pd.DataFrame) -> pd.DataFrame:
    """Give, of every curve, what its judgement needs: of what points leave open, the most."""
    own = points.assign(open=resolution(points)).groupby(CURVE, sort=False)
    return own[["shares_scheme", "judged", "accuracy", "open"]].max().reset_index()


def _exact_edges(reference: pd.DataFrame, points: pd.DataFrame) -> pd.DataFrame:
    """Give, of every edge of the reference, the exact motion's, its bar, and by how much the scheme's step moves it."""
    rows = []
    for own in reference.itertuples():
        at = points[(points.case == ruled_case(own)) & (points.steps == own.steps) & is_reference(points)]
        for point in at.itertuples():
            per_amplitude = DB / abs(own.slope or FLAT)
            place = point.frequency_ratio - (point.exact_db - THRESHOLD_DB) / (own.slope or FLAT)
            bar, scheme = point.exact_bar * per_amplitude, point.scheme_error * per_amplitude
            read = own.interpolation + KINK * own.width
            rows.append((own.curve, own.steps, own.edge, place, bar, scheme, own.frequency_ratio, read))
    names = ["curve", "steps", "edge", "exact", "exact_bar", "scheme", "reference", "reference_bar"]
    return pd.DataFrame(rows, columns=names)
