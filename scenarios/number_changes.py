"""What has become of the numbers of scenarios from one store to another, by their distance from the exact values."""

from collections.abc import Hashable, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.numbers import numbers
from multibody_xval.scenarios.changes import (
    IMPROVED,
    MISSING,
    NEW,
    NOT_RUN,
    RANKS,
    REGRESSED,
    UNCHANGED,
    UNKNOWN,
    with_texts,
)
from multibody_xval.scenarios.model import EXACT, REFERENCE, AnyCase, Case, Config
from multibody_xval.scenarios.result_tables import CONFIG
from multibody_xval.scenarios.store import Stored

NUMBER = ["scenario", "configuration", "scenario_case", "steps", "quantity", "unit"]
"""Columns that numbers are joined on."""

TWICE = ["engine", "version", "options", "status", "reason", "value", "error", "resolution"]
"""Columns of a number that a comparison has twice."""

DONE = "finished"


Store = tuple[Sequence[Stored], Mapping[str, str]]
"""Results of a store, one a run, and options by configuration."""


def number_changes(before: Store, now: Store, db: float) -> pd.DataFrame:
    """Compare the numbers of motions and scenes that either store holds; those of steady states are points.

    The reference and the exact motions of either store judge both, those of the first where both have them.

    Parameters
    ----------
    before, now
        Results of both stores.
    db
        Largest change that does not count, as a part of the number [dB].
    """
    ruler = {row.run: row for row in (*now[0], *before[0]) if row.run.config in (REFERENCE, EXACT)}
    sides = [
        _side([*ruler.values(), *(row for row in rows if row.run not in ruler)], own) for rows, own in (before, now)
    ]
    rows = sides[0].merge(sides[1], on=NUMBER, how="outer", suffixes=("_before", "_now"), sort=False)
    rows = with_texts(rows)
    named = rows.scenario + ", " + rows.scenario_case + ": " + rows.quantity
    return _changes(rows.assign(case=named, error_percent_before=np.nan, error_percent_now=np.nan), 10 ** (db / 20) - 1)


def _side(stored: Sequence[Stored], options: Mapping[str, str]) -> pd.DataFrame:
    """Give the numbers of one store."""
    cases: set[AnyCase] = {row.run.case for row in stored if not isinstance(row.run.case, Case)}
    found = [numbers(own, stored) for own in SCENARIOS.values() if not cases.isdisjoint(own.cases.values())]
    if not found:
        return pd.DataFrame(columns=[*NUMBER, *TWICE]).astype({"steps": int, **dict.fromkeys(TWICE[5:], float)})
    rows = pd.concat(found, ignore_index=True).rename(columns={"case": "scenario_case"})
    rows = rows[rows.engine != REFERENCE.engine]
    names = [str(Config(*own)) for own in rows[CONFIG].to_numpy().tolist()]
    rows = rows.assign(
        options=[options.get(name, "{}") for name in names],
        status=rows.verdict.where(rows.verdict.isin(list(RANKS)), DONE),
        **{name: rows[name].astype(float) for name in ("value", "error", "resolution")},
    )
    return rows[[*NUMBER, *TWICE]]


def _changes(rows: pd.DataFrame, least: float) -> pd.DataFrame:
    """Add what has become of each number, and in words what has changed."""
    left = (rows.resolution_before + rows.resolution_now).clip(lower=least * rows.value_before.abs())
    moved = (rows.value_now - rows.value_before).abs() > left
    farther = rows.error_now.abs() - rows.error_before.abs()
    ranks = {**RANKS, DONE: 0}
    was, is_now = rows.status_before.map(ranks), rows.status_now.map(ranks)
    change = np.select(
        [is_now > was, (was == ranks[NOT_RUN]) & (is_now < was), is_now < was, ~moved, farther.isna(), farther > left,
         farther < -left],
        [MISSING, NEW, IMPROVED, UNCHANGED, UNKNOWN, REGRESSED, IMPROVED],
        UNCHANGED,
    )  # fmt: skip
    return rows.assign(change=change, what=[_words(*own) for own in zip(moved, rows.to_dict("records"), strict=True)])


def _words(moved: bool, row: dict[Hashable, Any]) -> str:
    """Say what has changed, with the reason of the run that is worse."""
    if row["status_before"] != row["status_now"]:
        reason = row["reason_now"] or row["reason_before"]
        return f"{row['status_before']} before, {row['status_now']} now" + (f": {reason}" if reason else "")
    if not moved:
        return ""
    values = f"{row['value_before']:.5g} → {row['value_now']:.5g} {row['unit']}".strip()
    return f"{values}, error {row['error_before']:+.2g} → {row['error_now']:+.2g}"
