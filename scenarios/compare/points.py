"""What has become of points from one table to another, by their distance from the exact motion."""

from collections.abc import Iterable

import numpy as np
import pandas as pd

from multibody_xval.scenarios.model import CASE
from multibody_xval.scenarios.result_tables import is_exact, is_reference
from multibody_xval.scenarios.ruler.judge import FLOOR, amplitude, judged, resolution

REGRESSED, MISSING, UNKNOWN = "regressed", "missing", "unknown"
IMPROVED, NEW, UNCHANGED = "improved", "new", "unchanged"

CHANGES = (REGRESSED, MISSING, UNKNOWN, IMPROVED, NEW, UNCHANGED)
"""What a point may have become, the worst first; unknown where it has changed and there is no exact value."""

LEAST_DB = 0.001
"""Change that counts as none, unless a user says so: 0.01 % of amplitude, far below the error of any step."""

LEAST_STUCK = 0.01
"""Change of the part of a period that a contact sticks that counts as none, and two time steps more."""

NOT_RUN = "not run"

RANKS = {"periodic": 0, "finished": 0, "not periodic": 1, "failed": 2, "unsupported": 3, NOT_RUN: 3}
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
    rows = _changes(joined(one, other, POINT), 100 * (10 ** (db / 20) - 1))
    case = pd.DataFrame([{name: getattr(own, name) for name in CASE} for own in rows.case], rows.index, CASE)
    first = [*POINT, "change", "what"]
    return pd.concat([rows[first], case, rows.drop(columns=first)], axis=1)


def joined(before: pd.DataFrame, now: pd.DataFrame, on: list[str]) -> pd.DataFrame:
    """Join two tables, and add the rows that only the second has: cases have no order to sort by.

    What says who ran a row and how it ended is filled where only the other side has it.
    """
    known = before[on].assign(known=True)
    new = now.merge(known, on=on, how="left").query("known.isna()").drop(columns="known")
    rows = before.merge(now, on=on, how="left", suffixes=("_before", "_now"))
    rows = pd.concat([rows, new.rename(columns={name: f"{name}_now" for name in now if name not in on})])
    texts = {"status": NOT_RUN, "engine": "", "version": "", "options": "", "reason": ""}
    filled = {f"{name}{side}": text for name, text in texts.items() for side in ("_before", "_now")}
    whole = rows.reset_index(drop=True).astype(dict.fromkeys(filled, object)).fillna(filled)
    return whole.infer_objects()  # numbers of an empty table are objects


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
        direction(moved, rows.error_percent_now - rows.error_percent_before, left),
        direction(other_stuck, rows.stuck_error_now - rows.stuck_error_before, stuck_left),
    )
    words = _ratio_words(rows).where(moved, ""), ("stuck fraction " + stuck.map("{:.2g}".format)).where(other_stuck, "")
    return with_change(rows, worst, [", ".join(filter(None, own)) for own in zip(*words, strict=True)])


def direction(moved: pd.Series, farther: pd.Series, left: pd.Series | float) -> np.ndarray:
    """Give the place in `CHANGES` of every row by how much farther from the exact value it is."""
    conditions = [~moved, farther.isna(), farther > left, farther < -left]
    found = [CHANGES.index(name) for name in (UNCHANGED, UNKNOWN, REGRESSED, IMPROVED)]
    return np.select(conditions, found, CHANGES.index(UNCHANGED))


def with_change(rows: pd.DataFrame, place: np.ndarray, words: Iterable[str]) -> pd.DataFrame:
    """Add what has become of each row, and in words what has changed: how runs have ended decides first.

    `place` in `CHANGES` and `words` say what has become of the numbers; of runs that have ended in two ways, the reason
    is that of the worse.
    """
    was, is_now = rows.status_before.map(RANKS), rows.status_now.map(RANKS)
    change = np.select(
        [is_now > was, (was == RANKS[NOT_RUN]) & (is_now < was), is_now < was, is_now > 0],
        [MISSING, NEW, IMPROVED, UNCHANGED],
        np.array(CHANGES)[place],
    )
    reason = rows.reason_now.where(rows.reason_now != "", rows.reason_before)
    ended = rows.status_before + " before, " + rows.status_now + " now" + (": " + reason).where(reason != "", "")
    what = pd.Series(words, rows.index, dtype=object)
    return rows.assign(change=change, what=what.where(rows.status_before == rows.status_now, ended))


def _ratio_words(rows: pd.DataFrame) -> pd.Series:
    level = (rows.transmittance_db_now - rows.transmittance_db_before).map("{:+.2g} dB".format)
    turn = pd.Series(np.degrees(np.angle((rows.ratio_now / rows.ratio_before).astype(complex))), rows.index)
    return "transmittance " + level + turn.map(" and {:+.2g}°".format)
