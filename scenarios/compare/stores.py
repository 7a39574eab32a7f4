"""What two stores or two configurations have in common, and where the second is closer to the exact motion."""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import pandas as pd

from multibody_xval.scenarios.compare.numbers import number_changes
from multibody_xval.scenarios.compare.points import (
    CHANGES,
    IMPROVED,
    LEAST_DB,
    MISSING,
    NEW,
    NOT_RUN,
    POINT,
    REGRESSED,
    UNKNOWN,
    compared,
)
from multibody_xval.scenarios.model import LARGEST_DECIBEL, REFERENCE, Config
from multibody_xval.scenarios.plan import compared_configs, guard_cases, runs_at
from multibody_xval.scenarios.result_tables import full_name, points
from multibody_xval.scenarios.running.evaluate import Means, computed, stored_results
from multibody_xval.scenarios.store import Stored, existing_store, identity, opened
from reference_lcp.errors import ParameterError
from reference_lcp.validation import checked_scalar

RUN = ["config", "case", "steps"]

MOST_NAMED = 6
"""Configurations of a store that a message names."""


def compare(first: Path | str, second: Path | str, *, db: float = LEAST_DB) -> pd.DataFrame:
    """Compare the results of two stores point by point, by their errors to the exact motion.

    Points are matched by configuration, case and steps per period; versions and options of engines may differ, and of
    several versions in one store the last counts. Where each store has one configuration of an engine, formulation and
    preset, the two are matched though other options are changed in them, and named ``before -> now``. The reference and
    the exact motion of either store judge both.
    Numbers of scenarios about motions and scenes are matched by their case and name, and count as points.

    Parameters
    ----------
    first, second
        Files that `sweep` or `report` has written: before, and now.
    db
        Largest change that does not count [dB of amplitude]; one of the phase counts as the change of amplitude that is
        as large.

    Returns
    -------
    DataFrame
        One row a point: ``configuration``, columns of the case, ``steps``, ``change`` (regressed, missing, unknown,
        improved, new or unchanged), ``what`` (what has changed, in words; empty where nothing has), and the numbers of
        both with the endings ``_before`` and ``_now``, such as ``error_percent_before``. Numbers have a ``scenario``,
        a ``scenario_case``, a ``quantity`` and a ``unit``, with ``value`` and ``error`` in that.

    Raises
    ------
    ParameterError
        If a file is no store, the stores have no point in common, or `db` is outside its range.
    """
    checked_db(db)
    old, new = map(_results_of, [existing_store(file) for file in (first, second)])
    matched = _matched(old[0], new[0])
    before, now = _points_of(*old, matched), _points_of(*new, matched)
    numbers = number_changes(old, new, db, matched)
    _check_common(before, now, numbers, " and ".join(_named(*own) for own in ((first, old[0]), (second, new[0]))))
    rows = pd.concat([*_points_compared(before, now, db), numbers], ignore_index=True)
    return rows.sort_values("configuration", key=_is_reference, kind="stable", ignore_index=True)


def _points_compared(before: pd.DataFrame, now: pd.DataFrame, db: float) -> Iterator[pd.DataFrame]:
    """Give the points compared, where there are any; the reference's count where both stores have them."""
    both = pd.concat([before, now], ignore_index=True)
    if both.empty:
        return
    ruler = both[both.status == "periodic"].drop_duplicates(RUN)
    rows = compared(before, now, ruler, db)
    alone = (rows.status_before == NOT_RUN) | (rows.status_now == NOT_RUN)
    yield rows[~(alone & _is_reference(rows.configuration))]


def _is_reference(names: pd.Series) -> pd.Series:
    return names == full_name(REFERENCE)


def changes_between(before: str, now: str, means: Means, db: float = LEAST_DB) -> pd.DataFrame:
    """Compute two configurations, or the presets of two engines, at 24 points, and compare them.

    Raises
    ------
    ParameterError
        If a name is unknown, an engine not installed, or the two have no formulation and preset in common.
    """
    checked_db(db)
    found = pairs(compared_configs(before), compared_configs(now))
    if not found:
        raise ParameterError(f"{before} and {now} have no formulation and preset in common; allowed: two that have")
    configs = [config for pair in found for config in pair]
    table = points(computed(runs_at(configs, guard_cases()), means, f"{before} and {now}"))
    table["options"] = [identity(config)[1] for config in table.config]
    named = [(" -> ".join(map(full_name, pair)), pair) for pair in found]
    one, other = (
        pd.concat([table[table.config == pair[k]].assign(configuration=name) for name, pair in named]) for k in (0, 1)
    )
    return compared(one, other, table, db)


def checked_db(db: float) -> float:
    """Give the largest change that does not count [dB], if it may be one."""
    return checked_scalar("db", db, "> 0", LARGEST_DECIBEL)


def _results_of(file: Path) -> tuple[list[Stored], dict[str, str]]:
    """Give the results of a store, of several versions of an engine the last, and options by configuration."""
    found = {row.run: row for row in stored_results(file)}
    with opened(file) as store:
        return list(found.values()), store.options()


def _points_of(stored: Sequence[Stored], options: Mapping[str, str], matched: Mapping[str, str]) -> pd.DataFrame:
    """Give the points of a store, with options, and names by which configurations are matched."""
    table = points(stored)
    return table.assign(
        options=[options[str(config)] for config in table.config], configuration=table.configuration.replace(matched)
    )


def _matched(before: Sequence[Stored], now: Sequence[Stored]) -> dict[str, str]:
    """Name two configurations alike where each store has one of a preset, and other options are changed in them."""
    sides = [_by_preset(own) for own in (before, now)]
    alone = [
        [side[preset][0] for side in sides] for preset in sides[0] if all(len(side[preset]) == 1 for side in sides)
    ]
    return {name: " -> ".join(names) for names in alone if names[0] != names[1] for name in names}


def _by_preset(stored: Sequence[Stored]) -> defaultdict[Config, list[str]]:
    """Give the names of configurations by the presets that they change options of."""
    found = defaultdict(list)
    for config in _configs(stored):
        found[config.unchanged].append(full_name(config))
    return found


def _configs(stored: Sequence[Stored]) -> list[Config]:
    """Give the configurations of engines, each once."""
    return [own for own in dict.fromkeys(row.run.config for row in stored) if own.engine != REFERENCE.engine]


def _named(file: Path | str, stored: Sequence[Stored]) -> str:
    """Name a store with the configurations of engines that it has."""
    names = list(map(full_name, _configs(stored)))
    more = [f"and {len(names) - MOST_NAMED} more"] if len(names) > MOST_NAMED else []
    return f"{file} ({', '.join([*names[:MOST_NAMED], *more]) or 'of no engine'})"


def _check_common(before: pd.DataFrame, now: pd.DataFrame, numbers: pd.DataFrame, stores: str) -> None:
    """Refuse stores that have neither a point nor a number in common; those of the reference are in every store."""
    if ((numbers.status_before != NOT_RUN) & (numbers.status_now != NOT_RUN)).any():
        return
    sets = [set(zip(*(table[name] for name in POINT), strict=True)) for table in (before, now)]
    of_engines = [table[table.engine != REFERENCE.engine] for table in (before, now)]
    engines = [set(zip(*(table[name] for name in POINT), strict=True)) for table in of_engines]
    if not set.intersection(*(engines if any(engines) else sets)):
        raise ParameterError(
            f"{stores} have no point in common; allowed: stores with the same configurations, or one of each preset "
            "with other options, the same cases and steps per period (any two configurations: compare --engine A "
            "--engine B)"
        )


def summary(changes: pd.DataFrame) -> pd.DataFrame:
    """Count what has become of points, a row a configuration, with the largest error before and now [%].

    Columns of what has become of none are left out, but ``regressed``, and errors where nothing has any.
    """
    own = changes.groupby("configuration", sort=False)
    counts = own.change.value_counts().unstack(fill_value=0).reindex(columns=list(CHANGES), fill_value=0)
    counts = counts.loc[:, counts.any() | (counts.columns == REGRESSED)]
    worst = own[["error_percent_before", "error_percent_now"]].max()
    worst.columns = ["error before [%]", "error now [%]"]
    worst = worst.dropna(axis="columns", how="all")
    return pd.concat([own.size().rename("points"), counts, worst], axis=1).reset_index()


def fails(changes: pd.DataFrame, *, strict: bool = False) -> bool:
    """Whether anything is worse, or has changed where no exact value says where to; strictly, whether anything has."""
    any_change = (changes.what != "") & (changes.change != NEW)
    return bool((changes.change.isin([REGRESSED, MISSING, UNKNOWN]) | (strict & any_change)).any())


def conclusion(changes: pd.DataFrame, before: str, now: str) -> str:
    """Say in one sentence what has come out."""
    counts = {name: int((changes.change == name).sum()) for name in CHANGES}
    parts = ", ".join(f"{count} {name}" for name, count in counts.items() if count)
    better, worse = counts[IMPROVED], counts[REGRESSED]
    if better > worse:
        verdict = f"{now} is closer to the exact motion"
    elif better < worse:
        verdict = f"{before} is closer to the exact motion"
    elif counts[UNKNOWN]:
        verdict = "no exact value says which of the two is closer to the exact motion"
    elif counts[MISSING] == len(changes):
        verdict = "the second has no result"
    elif counts[MISSING]:
        verdict = "where both have a result, both are as close to the exact motion"
    else:
        verdict = "both are as close to the exact motion"
    points_text = f"{len(changes)} point" + "s" * (len(changes) != 1)
    return f"{points_text}, from {before} to {now}: {parts}: {verdict}."


def pairs(before: Sequence[Config], now: Sequence[Config]) -> list[tuple[Config, Config]]:
    """Give what is compared: the same formulation and preset, whatever the options, or the only two configurations."""
    if len(before) == len(now) == 1:
        return [(before[0], now[0])]
    return [
        (one, other) for one in before for other in now
        if (one.formulation, one.unchanged.preset_name) == (other.formulation, other.unchanged.preset_name)
    ]  # fmt: skip
