"""Where curves cross the threshold, as well as their points tell.

The band holds the first deep attenuation of a curve, and extends to where the curve crosses the threshold. Ripple in
the pass band dips below the threshold too, but not as deep. Curves of time-stepping schemes have kinks, where contacts
stick for a step more: an edge is known as well as the four points around it say, not as well as a smooth curve would.
"""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from multibody_xval.scenarios.model import Case, Config
from multibody_xval.scenarios.result_tables import CURVE, is_exact, is_reference, rows_of
from multibody_xval.scenarios.ruler.exact_values import has_ruler
from multibody_xval.scenarios.ruler.judge import FLOOR_DB
from reference_lcp.defaults import FEWEST_STEPS_PER_PERIOD

THRESHOLD_DB, DEPTH_DB = 0.0, -10.0
"""Transmittance at the edges, and below which an attenuation is deep."""

WIDTH, CLOSE = 1e-4, 1e-6
"""Of the bracket of a refined edge, and how far off the edge may be, both in η_r: a step of 400 per period moves edges
by fifty times as much."""

FEWEST_POINTS = 4
"""Points of a curve of which it is said that an edge is absent: fewer are single points, as those of a headline."""

RESOLVED_SPACING, CLOSE_DB = 0.0125, 3.0
"""A curve that runs this close below the threshold is resolved to this spacing: a crossing may hide there."""

EDGES = ("lower", "upper")


class Crossing(NamedTuple):
    """Where a curve crosses the threshold, by the two points beside the crossing and their neighbours."""

    guess: float
    low: float
    high: float
    """Between these it lies, if the curve bends one way there."""
    width: float
    slope: float
    """Straight from one point to the other [dB per η_r]."""


NOWHERE = Crossing(*[np.nan] * 5)

COLUMNS = {
    "edge": str,
    "frequency_ratio": float,
    **dict.fromkeys(Crossing._fields, float),
    "interpolation": float,
    "peak": float,
    "before": int,
    "after": int,
    "lost": int,
    "absent": str,
}


def edges(table: pd.DataFrame) -> pd.DataFrame:
    """Give the edges of every curve, as far as its points tell, and which a curve has not.

    Columns: those of `CURVE`, with the ``steps`` that were asked for; ``edge`` (lower or upper); ``frequency_ratio``,
    NaN where there is none or none is known, and ``absent``, which then says why; ``lost``: how many points without a
    steady state leave it unknown; ``guess``, ``low`` and ``high``: where it is looked for, and ``interpolation``: how
    far off that may be; ``width`` of its bracket; all in η_r; ``slope`` [dB per η_r]; ``peak``: how high over the
    threshold the curve rises before it falls below again [dB]; ``before`` and ``after``: the rows of the table beside
    it, or -1.
    """
    rows = [(*curve.key, *own) for curve in curves(table) for own in _edges_of(curve)]
    return pd.DataFrame(rows, columns=[*CURVE, *COLUMNS]).astype(
        {**dict.fromkeys(CURVE, str), "curve": object, "steps": int, **COLUMNS}
    )


def refined(found: pd.DataFrame) -> pd.Series:
    """Tell which edges need no more runs."""
    return found.frequency_ratio.notna() & (found.width <= WIDTH) & (found.interpolation <= CLOSE)


class Curve(NamedTuple):
    """The points of a curve by ascending frequency."""

    config: Config
    case: Case
    """With a frequency ratio of 1."""
    steps: int
    """As they were asked for: chains that need more at low frequencies are one curve."""
    key: tuple[Any, ...]
    """The values of `CURVE`."""
    eta: NDArray[np.float64]
    level: NDArray[np.float64]
    """[dB]; NaN of points without a steady state."""
    row: NDArray[np.int64]
    """Their rows in the table."""

    @property
    def steady(self) -> "Curve":
        """Leave out points without a steady state."""
        there = ~np.isnan(self.level)
        return self._replace(eta=self.eta[there], level=self.level[there], row=self.row[there])


def curves(table: pd.DataFrame) -> Iterator[Curve]:
    """Give every curve of a table."""
    own = table[~is_exact(table) & ~_finer(table)]
    of_curve = own.groupby(CURVE[:-1], sort=False, dropna=False).ngroup()
    own = own.assign(of_curve=of_curve, steps=_asked_steps(own, of_curve)).sort_values("frequency_ratio", kind="stable")
    own = own.drop_duplicates(["of_curve", "steps", "frequency_ratio"])
    eta, rows = own.frequency_ratio.to_numpy(), own.index.to_numpy()
    level = own.transmittance_db.where(own.status == "periodic").to_numpy()
    configs, cases, keys = own.config.tolist(), own.curve.tolist(), list(rows_of(own, *CURVE))
    for places in own.groupby(["of_curve", "steps"], sort=False).indices.values():
        first = places[0]
        key = keys[first]
        yield Curve(configs[first], cases[first], int(key[-1]), key, eta[places], level[places], rows[places])


def _finer(table: pd.DataFrame) -> pd.Series:
    """Tell which rows the reference has only to show its error: they lack finer ones, and are not the coarsest."""
    own = table[is_reference(table)]
    coarsest = own.groupby("case", sort=False).steps.transform("min") == own.steps
    return (~coarsest & ~has_ruler(own)).reindex(table.index, fill_value=False)


def _asked_steps(rows: pd.DataFrame, of_curve: pd.Series) -> pd.Series:
    """Give the steps per period that were asked for, also where a case needs more."""
    needed = {case: case.steps(FEWEST_STEPS_PER_PERIOD) for case in dict.fromkeys(rows.case)}
    free = rows.steps.where(rows.steps > rows.case.map(needed).astype(float))
    fewest = rows.steps.groupby(of_curve).transform("min")
    return free.fillna(free.groupby(of_curve).transform("min")).fillna(fewest).astype(int)


def brackets(level_db: NDArray[np.float64]) -> dict[str, int]:
    """Give the position before each edge that a curve holds."""
    deep, above = np.flatnonzero(level_db < DEPTH_DB), np.flatnonzero(level_db >= THRESHOLD_DB)
    if not deep.size:
        return {}
    before, after = above[above < deep[0]], above[above > deep[0]]
    return {name: int(rows[0]) for name, rows in (("lower", before[-1:]), ("upper", after[:1] - 1)) if rows.size}


def _edges_of(curve: Curve) -> Iterator[tuple[object, ...]]:
    """Give both edges of a curve, or why it has none."""
    own = curve.steady
    eta, level, found = own.eta, own.level, brackets(own.level)
    lost = curve.eta[np.isnan(curve.level)]
    for name in EDGES:
        row = found.get(name)
        if row is not None:
            place = crossing(eta, np.maximum(level, FLOOR_DB) - THRESHOLD_DB, row)
            off = max(place.high - place.guess, place.guess - place.low)
            count = int(((lost > eta[row]) & (lost < eta[row + 1])).sum())
            shown = np.nan if count else place.guess
            why = f"not periodic at {count} points from {eta[row]:g} to {eta[row + 1]:g}" if count else ""
            peak = _peak(level[row::-1] if name == "lower" else level[row + 1 :])
            yield name, shown, *place, off, peak, own.row[row], own.row[row + 1], count, why
        elif curve.eta.size >= FEWEST_POINTS:
            yield name, np.nan, *NOWHERE, np.nan, np.nan, -1, -1, *_absent(name, eta, level, lost)


def _peak(level: NDArray[np.float64]) -> float:
    """Give how high a curve rises from an edge on, until it falls below the threshold; infinite where it does not."""
    below = np.flatnonzero(level < THRESHOLD_DB)
    return float(level[: below[0]].max()) - THRESHOLD_DB if below.size else np.inf


def _absent(
    name: str, eta: NDArray[np.float64], level: NDArray[np.float64], lost: NDArray[np.float64]
) -> tuple[int, str]:
    """Give the number of points without a steady state where a curve may have an edge, and why it shows none."""
    deep = np.flatnonzero(level < DEPTH_DB)
    if deep.size:
        before = name == "lower"
        lost = lost[lost < eta[deep[0]]] if before else lost[lost > eta[deep[0]]]
    if lost.size:
        return lost.size, f"not periodic at {lost.size} points"
    if not deep.size:
        return 0, f"no attenuation below {DEPTH_DB:g} dB up to {eta[-1]:g}"
    return 0, f"below {THRESHOLD_DB:g} dB " + (f"from {eta[0]:g} on" if before else f"up to {eta[-1]:g}")


def crossing(eta: NDArray[np.float64], level: NDArray[np.float64], row: int) -> Crossing:
    """Give where a curve crosses zero between two neighbours, of which one is below it.

    A curve that bends one way lies between its chord and the chords of the intervals on either side, which may have a
    kink between them; the best guess is a cubic's.
    """
    first, last = eta[row], eta[row + 1]
    straight = _root(eta, level, row)
    ahead = _root(eta, level, row - 1) if row else last
    back = _root(eta, level, row + 1) if row + 2 < eta.size else first
    ends = (straight, min(ahead, last) if ahead >= first else last, max(back, first) if back <= last else first)
    near = slice(max(row - 1, 0), row + 3)
    roots = PchipInterpolator(eta[near], level[near]).solve(extrapolate=False)
    inside = roots[(roots >= first) & (roots <= last)]
    place = float(np.clip(inside[0] if inside.size else straight, min(ends), max(ends)))
    width = float(last - first)
    return Crossing(place, float(min(ends)), float(max(ends)), width, float(level[row + 1] - level[row]) / width)


def _root(eta: NDArray[np.float64], level: NDArray[np.float64], row: int) -> float:
    """Give where the straight line through a point and the next crosses zero; far away where it is level."""
    rise = level[row + 1] - level[row]
    return float(eta[row] - level[row] * (eta[row + 1] - eta[row]) / rise) if rise else np.inf


def hidden(curve: Curve) -> list[float]:
    """Give the frequencies that a curve still needs above its lower edge and up to its depth, to hide no crossing."""
    own = curve.steady
    eta, level = own.eta, own.level
    deep = np.flatnonzero(level < DEPTH_DB)
    if not deep.size:
        return []
    inside = slice(brackets(level).get("lower", 0), int(deep[0]) + 1)
    left, right = eta[inside][:-1], eta[inside][1:]
    close = np.maximum(level[inside][:-1], level[inside][1:]) > THRESHOLD_DB - CLOSE_DB
    wide = right - left > RESOLVED_SPACING * (1 + 1e-9)
    return np.round((left + right)[close & wide] / 2, 6).tolist()
