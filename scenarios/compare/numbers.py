"""What has become of the numbers of scenarios from one store to another, by their distance from the exact values."""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.numbers import numbers
from multibody_xval.scenarios.compare.points import RANKS, direction, joined, with_change
from multibody_xval.scenarios.model import EXACT, REFERENCE, AnyCase, Case, Config
from multibody_xval.scenarios.result_tables import CONFIG, rows_of
from multibody_xval.scenarios.store import Stored

NUMBER = ["scenario", "configuration", "scenario_case", "steps", "quantity", "unit"]
"""Columns that numbers are joined on."""

TWICE = ["engine", "version", "options", "status", "reason", "verdict", "value", "error", "allowed", "resolution"]
"""Columns of a number that a comparison has twice."""

SIZES = TWICE[6:]
"""Those in the unit of the number."""

Store = tuple[Sequence[Stored], Mapping[str, str]]
"""Results of a store, one a run, and options by configuration."""


def number_changes(before: Store, now: Store, db: float, matched: Mapping[str, str]) -> pd.DataFrame:
    """Compare the numbers of motions and scenes that either store holds; those of steady states are points.

    The reference and the exact motions of either store judge both, those of the first where both have them.

    Parameters
    ----------
    before, now
        Results of both stores.
    db
        Largest change that does not count, as a part of the number [dB].
    matched
        Names by which configurations are matched that have other names of their own.
    """
    ruler = {row.run: row for row in (*now[0], *before[0]) if row.run.config in (REFERENCE, EXACT)}
    one, other = (
        _side([*ruler.values(), *(row for row in rows if row.run not in ruler)], own, matched)
        for rows, own in (before, now)
    )
    rows = _changes(joined(one, other, NUMBER).sort_values(NUMBER, ignore_index=True), 10 ** (db / 20) - 1)
    named = rows.scenario + ", " + rows.scenario_case + ": " + rows.quantity
    return rows.assign(case=named, error_percent_before=np.nan, error_percent_now=np.nan)


def _side(stored: Sequence[Stored], options: Mapping[str, str], matched: Mapping[str, str]) -> pd.DataFrame:
    """Give the numbers of one store."""
    cases: set[AnyCase] = {row.run.case for row in stored if not isinstance(row.run.case, Case)}
    found = [numbers(own, stored) for own in SCENARIOS.values() if not cases.isdisjoint(own.cases.values())]
    if not found:
        return pd.DataFrame(columns=[*NUMBER, *TWICE]).astype({"steps": int, **dict.fromkeys(SIZES, float)})
    rows = pd.concat(found, ignore_index=True).rename(columns={"case": "scenario_case"})
    rows = rows[rows.engine != REFERENCE.engine]
    rows = rows.assign(
        options=[options.get(str(Config(*own)), "{}") for own in rows_of(rows, *CONFIG)],
        status=rows.verdict.where(rows.verdict.isin(list(RANKS)), "finished"),
        configuration=rows.configuration.replace(matched),
        **{name: rows[name].astype(float) for name in SIZES},
    )
    return rows[[*NUMBER, *TWICE]]


def _changes(rows: pd.DataFrame, least: float) -> pd.DataFrame:
    """Add what has become of each number, and in words what has changed."""
    left = (rows.resolution_before + rows.resolution_now).clip(lower=least * rows.value_before.abs())
    moved = (rows.value_now - rows.value_before).abs() > left
    place = direction(moved, rows.error_now.abs() - rows.error_before.abs(), left)
    columns = ("value_before", "value_now", "unit", "error_before", "error_now")
    words = [_words(*own) if it else "" for it, own in zip(moved, rows_of(rows, *columns), strict=True)]
    return with_change(rows, place, words)


def _words(before: float, now: float, unit: str, error_before: float, error_now: float) -> str:
    values = f"{before:.5g} → {now:.5g} {unit}".strip()
    return f"{values}, error {error_before:+.2g} → {error_now:+.2g}"
