"""What has become of points from one table to another, by their distance from the exact motion."""

import numpy as np
import pandas as pd

from multibody_xval.scenarios.judge import FLOOR, amplitude, judged, resolution
from multibody_xval.scenarios.model import CASE
from multibody_xval.scenarios.result_tables import is_exact, is_reference

REGRESSED, MISSING, UNKNOWN = "regressed", "missing", "unknown"
IMPROVED, NEW, UNCHANGED = "improved", "new", "unchanged"

CHANGES = (REGRESSED, MISSING, UNKNOWN, IMPROVED, NEW, UNCHANGED)
"""What a point may have become, the worst first; unknown where it has changed and there is no exact value."""

LEAST_DB = 0.001
"""Change that counts as none, unless a user says so: 0.01 % of amplitude, far below the error of any step."""

LEAST_STUCK = 0.01
"""Change of the part of a period that a contact sticks that counts as none, and two time steps more."""

NOT_RUN = "not run"

RANKS = {"periodic": 0, "not periodic": 1, "failed": 2, "unsupported": 3, NOT_RUN: 3}
"""How little a run says."""

POINT = ["configuration", "case", "steps"]

_NUMBERS = [
    "engine", "version", "options", "status", "reason", "transmittance_db", "phase_deg", "ratio", "error_db",
    "error_deg", "error_percent", "open", "stuck", "stuck_error", "transitions",
]  # fmt: skip
"""Columns of a point that a comparison has twice."""


def compared(before: pd.DataFrame, now: pd.DataFrame, ruler: pd.DataFrame, db: float = LEAST_DB) -> pd.DataFrame:
    """Judge two tables of points by one ruler, and join them on the name of what is compared, case and steps."""
    one, other = (_measured(table, ruler)[[*POINT, *_NUMBERS]] for table in (before, now))
    rows = _joined(one, other)
    rows = _changes(with_texts(rows), 100 * (10 ** (db / 20) - 1))
    case = pd.DataFrame([{name: getattr(own, name) for name in CASE} for own in rows.case], rows.index, CASE)
    first = [*POINT, "change", "what"]
    return pd.concat([rows[first], case, rows.drop(columns=first)], axis=1)


def with_texts(rows: pd.DataFrame) -> pd.DataFrame:
    """Fill what says who ran a row and how it ended, where only the other side has it."""
    texts = {"status": NOT_RUN, "engine": "", "version": "", "options": "", "reason": ""}
    filled = {f"{name}{side}": text for name, text in texts.items() for side in ("_before", "_now")}
    return rows.astype(dict.fromkeys(filled, object)).fillna(filled)


def _joined(before: pd.DataFrame, now: pd.DataFrame) -> pd.DataFrame:
    """Join two tables on the point, and add the points that only the second has: cases have no order to sort by."""
    known = before[POINT].assign(known=True)
    new = now.merge(known, on=POINT, how="left").query("known.isna()").drop(columns="known")
    rows = before.merge(now, on=POINT, how="left", suffixes=("_before", "_now"))
    return pd.concat([rows, new.rename(columns={name: f"{name}_now" for name in _NUMBERS})], ignore_index=True)


def _measured(table: pd.DataFrame, ruler: pd.DataFrame) -> pd.DataFrame:
    """Add to judged points the error of their stuck fractions, and what each leaves open of its error [%]."""
    rows = judged(table, ruler)
    known = ruler[(is_exact(ruler) | is_reference(ruler)) & (ruler.status == "periodic")]
    finest = known.assign(stepped=is_reference(known)).sort_values(["stepped", "steps"], ascending=[False, True])
    exact = dict(zip(finest.case, finest.stuck, strict=True))
    apart = [_apart(own, exact.get(case, ())) for own, case in zip(rows.stuck, rows.case, strict=True)]
    return rows.assign(
        open=100 * resolution(rows) / amplitude(rows),
        stuck_error=pd.Series(apart, rows.index, dtype=float).where(rows.exact.notna()),
    )


def _apart(one: object, other: object) -> float:
    """Give the largest difference of stuck fractions; NaN where one has none."""
    if not (isinstance(one, tuple) and isinstance(other, tuple)) or not one or len(one) != len(other):
        return np.nan
    return float(np.max(np.abs(np.subtract(one, other))))


def _changes(rows: pd.DataFrame, least: float) -> pd.DataFrame:
    """Add what has become of each row, and in words what has changed."""
    left = (rows.open_before + rows.open_now).clip(lower=least).fillna(least)
    scale = rows.ratio_before.abs().clip(lower=FLOOR)
    moved = 100 * (rows.ratio_now - rows.ratio_before).abs() / scale > left
    stuck_left = LEAST_STUCK + 2 / rows.steps
    stuck = pd.Series(list(map(_apart, rows.stuck_before, rows.stuck_now)), rows.index, dtype=float)
    other_stuck = (stuck > stuck_left) & rows.ratio_before.notna() & rows.ratio_now.notna()
    worst = np.minimum(
        _direction(moved, rows.error_percent_now - rows.error_percent_before, left),
        _direction(other_stuck, rows.stuck_error_now - rows.stuck_error_before, stuck_left),
    )
    was, is_now = rows.status_before.map(RANKS), rows.status_now.map(RANKS)
    absent = RANKS[NOT_RUN]
    change = np.select(
        [is_now > was, (was == absent) & (is_now < was), is_now < was, is_now > 0],
        [MISSING, NEW, IMPROVED, UNCHANGED],
        np.array(CHANGES)[worst],
    )
    words = [_status_words(rows), _ratio_words(rows).where(moved, ""), ("stuck fraction " + stuck.map("{:.2g}".format))]
    words[2] = words[2].where(other_stuck, "")
    return rows.assign(change=change, what=[", ".join(filter(None, own)) for own in zip(*words, strict=True)])


def _direction(moved: pd.Series, farther: pd.Series, left: pd.Series | float) -> np.ndarray:
    """Give the place in `CHANGES` of every row by how much farther from the exact value it is."""
    conditions = [~moved, farther.isna(), farther > left, farther < -left]
    found = [CHANGES.index(name) for name in (UNCHANGED, UNKNOWN, REGRESSED, IMPROVED)]
    return np.select(conditions, found, CHANGES.index(UNCHANGED))


def _status_words(rows: pd.DataFrame) -> pd.Series:
    """Say how the runs have ended, where not alike, with the reason of the one that is worse."""
    reason = rows.reason_now.where(rows.reason_now != "", rows.reason_before)
    words = rows.status_before + " before, " + rows.status_now + " now" + (": " + reason).where(reason != "", "")
    return words.where(rows.status_before != rows.status_now, "")


def _ratio_words(rows: pd.DataFrame) -> pd.Series:
    level = (rows.transmittance_db_now - rows.transmittance_db_before).map("{:+.2g} dB".format)
    turn = pd.Series(np.degrees(np.angle((rows.ratio_now / rows.ratio_before).astype(complex))), rows.index)
    return "transmittance " + level + turn.map(" and {:+.2g}°".format)
