"""Tables of the page: functions of judged points."""

from collections.abc import Iterable, Sequence

import numpy as np
import pandas as pd

from multibody_xval.reports.figures.panels import FREQUENCY
from multibody_xval.reports.formatting import significant
from multibody_xval.scenarios.model import Case, Config, Status
from multibody_xval.scenarios.report_plan import HEADLINE, HEADLINE_STEPS, PRESETS
from multibody_xval.scenarios.result_tables import CONFIG, curve_of, full_name, is_reference, rows_of
from multibody_xval.scenarios.ruler.exact_values import has_ruler
from multibody_xval.scenarios.ruler.judge import OTHER_SCHEMES, VERDICTS
from multibody_xval.scenarios.store import Stored
from multibody_xval.scenarios.studies.claims import OPEN, STATED, TITLES, conclusions

NOT_ENOUGH = "not enough"
"""Said of recipes that leave an error beyond what is allowed."""

STICK_SLIP = Case(friction_ratio=0.1, frequency_ratio=1.5)
"""The point whose stick and slip is shown, if it is there."""


def labelled(rows: pd.DataFrame) -> pd.DataFrame:
    """Add how people read a row.

    Added columns: ``title`` of engine and formulation, with changed options, and with the version where there are
    several of one configuration; ``options``, the preset in words; ``place``, the case without its frequency ratio.
    """
    versions = rows.groupby("configuration").version.nunique()
    several = rows.configuration.map(versions) > 1
    ending = (" " + rows.version.replace("", "(not installed)")).where(several, "")
    titles = {config: _title(config) for config in rows.config.unique()}
    base = rows.preset.str.partition(":")[0]
    curves = rows.case.map(curve_of)
    places = {curve: place(curve) for curve in curves.unique()}
    return rows.assign(
        title=rows.config.map(titles) + ending, configuration=rows.configuration + ending,
        options=base.map(TITLES).fillna(base), place=curves.map(places),
    )  # fmt: skip


def _title(config: Config) -> str:
    changed = config.preset_name.split(":")[1:]
    return ", ".join([config.capabilities.title, str(config.formulation), *changed])


def place(case: Case) -> str:
    """Name every value of a case that is not the paper's, but its frequency ratio: ``friction ratio 0.3, cells 3``."""
    return ", ".join(f"{name} {text}" for name, text in case.words.items() if name != "frequency ratio")


def planned(table: pd.DataFrame, rows: pd.DataFrame) -> pd.DataFrame:
    """Give the judged rows that were planned, those with a ruler at their steps; `table` has the ruler's runs."""
    keys = table.loc[has_ruler(table), ["case", "steps"]].drop_duplicates()
    return rows.merge(keys, on=["case", "steps"])


def at_headline(rows: pd.DataFrame) -> pd.DataFrame:
    """Give the rows at the headline's points."""
    return rows[rows.case.isin(HEADLINE) & (rows.steps == HEADLINE_STEPS)]


def on_grid(rows: pd.DataFrame) -> pd.DataFrame:
    """Give the rows that lie on curves: all but the headline's, where nothing else has as many steps."""
    places = ["config", "place", "steps"]
    others = (~rows.case.isin(HEADLINE)).groupby([rows[name] for name in places]).transform("any")
    return rows[others | (rows.steps != HEADLINE_STEPS)]


def engines_only(rows: pd.DataFrame) -> pd.DataFrame:
    """Leave out the reference, which is not compared with itself."""
    return rows[~is_reference(rows)]


def largest_errors(rows: pd.DataFrame) -> pd.DataFrame:
    """Give, a row a configuration, how many points it has and how many are periodic, its errors, and where it is worst.

    Points that an engine does not support are not counted: they say nothing about steady states.

    Columns: ``title``, ``options``, ``configuration``, ``points``, ``periodic``, ``median_percent``,
    ``largest_percent``, ``largest_db``, ``largest_deg``, ``beyond``, whether an error is `OTHER_SCHEMES` times what is
    allowed, ``worst_case`` and ``status``, the commonest.
    """
    own = rows.assign(db=rows.error_db.abs(), deg=rows.error_deg.abs(), periodic=rows.status == Status.PERIODIC,
                      supported=rows.status != Status.UNSUPPORTED, beyond=rows.distance > OTHER_SCHEMES * rows.allowed,
                      )  # fmt: skip
    groups = own.groupby(["title", "options", "configuration"])
    found = groups.agg(
        points=("supported", "sum"), periodic=("periodic", "sum"), median_percent=("error_percent", "median"),
        largest_percent=("error_percent", "max"), largest_db=("db", "max"), largest_deg=("deg", "max"),
        beyond=("beyond", "any"),
        status=("status", lambda status: status.mode().iloc[0]),
    )  # fmt: skip
    known = own[own.error_percent.notna()]
    worst = known.loc[known.groupby("configuration").error_percent.idxmax()]
    cases = {name: case.title for name, case in zip(worst.configuration, worst.case, strict=True)}
    found = found.reset_index()
    return found.assign(worst_case=found.configuration.map(cases).astype(object).fillna(""))


def worst_first(worst: pd.DataFrame) -> pd.DataFrame:
    """Sort engines and formulations, the largest error with default options first."""
    default = worst[worst.options == TITLES["default"]].set_index("title").largest_db
    return (
        worst.assign(order=-worst.title.map(default))
        .sort_values(["order", "title"], kind="stable")
        .drop(columns="order")
    )


def error_text(error_db: float, points: int, periodic: int, status: str) -> str:
    """Give an error for people, with how many points have one where that is not all of them."""
    if not periodic:
        return {Status.NOT_PERIODIC.value: "no steady state"}.get(status, status)
    text = "unknown" if np.isnan(error_db) else significant(error_db)
    return text if periodic == points else f"{text} ({periodic} of {points})"


def headline(worst: pd.DataFrame) -> pd.DataFrame:
    """Give the largest errors in dB, a row an engine and formulation, and say which recipes are not enough."""
    numbers = zip(worst.largest_db, worst.points, worst.periodic, worst.status, strict=True)
    uncured = (worst.options == TITLES["recommended"]) & worst.beyond & (worst.periodic > 0)
    endings = uncured.map({True: f"; {NOT_ENOUGH}", False: ""})
    texts = worst.assign(text=[error_text(*own) + ending for own, ending in zip(numbers, endings, strict=True)])
    wide = texts.pivot_table(index="title", columns="options", values="text", aggfunc="first", sort=False)
    usual = [TITLES[name] for name in PRESETS]
    wide = wide.reindex(columns=[*usual, *(name for name in wide if name not in usual)])
    return wide.dropna(axis=1, how="all").fillna("–").reset_index().rename_axis(columns=None)


def verdict_counts(rows: pd.DataFrame) -> pd.DataFrame:
    """Count the verdicts of every configuration; `judged` says whether they decide the exit code."""
    counts = rows.groupby(["configuration", "judged"]).verdict.value_counts().unstack(fill_value=0)
    counts = counts.reindex(columns=[name for name in VERDICTS if name in counts]).reset_index()
    return counts.assign(judged=counts.judged.map({True: "yes", False: "no"})).rename_axis(columns=None)


def edge_table(edges: pd.DataFrame) -> pd.DataFrame:
    """Give the edges as people read them, those of the reference first."""
    if edges.empty:
        return pd.DataFrame(columns=["title", "options", "configuration", "place", "edge", FREQUENCY, "verdict"])
    configs = pd.Series([Config(*own) for own in rows_of(edges, *CONFIG)], edges.index, dtype=object)
    own = edges.assign(config=configs, case=edges.curve, configuration=configs.map(full_name))
    names = [
        "title", "options", "configuration", "place", "steps", "edge", FREQUENCY, "exact", "exact_bar", "error",
        "expected", "allowed", "judged", "verdict", "absent",
    ]  # fmt: skip
    return labelled(own)[names].reset_index(drop=True)


def claim_table(points: pd.DataFrame, edges: pd.DataFrame) -> pd.DataFrame:
    """Give what is decided of the paper's claims, a row a configuration; empty where none is."""
    found = conclusions(points, edges)
    decided = (found[list(STATED)] != OPEN).any(axis=1)
    return found.loc[decided, ["configuration", "version", *STATED, "sentence"]]


def engines(stored: Iterable[tuple[Config, str]]) -> pd.DataFrame:
    """Give the version of every configuration, and its options that differ from the engine's own."""
    rows = [(str(config), version, _changed(config)) for config, version in sorted(set(stored), key=str)]
    return pd.DataFrame(rows, columns=["configuration", "version", "changed options"])


def _changed(config: Config) -> str:
    changed = {name: own for name, own in config.preset.options.items() if own.value != own.default}
    return ", ".join(f"{name} = {own.value!r}" for name, own in changed.items())


def mode_table(stored: Sequence[Stored], case: Case) -> pd.DataFrame:
    """Give when each contact sticks and slips over a period: a row a phase of a contact of a configuration.

    Columns: ``configuration``, ``steps``, ``cell``, ``begin`` and ``length`` over the period, ``mode``. A contact that
    never changes has one phase: it always sticks or always slips.
    """
    rows = [
        (full_name(run.config), version, run.config, run.steps, cell, *phase)
        for run, version, result in stored
        if run.case == case and result.status is Status.PERIODIC
        for cell, stuck in enumerate(result.stuck, 1)
        for phase in phases([(time, mode) for own, time, mode in result.transitions if own == cell], stuck)
    ]  # fmt: skip
    names = ["configuration", "version", "config", "steps", "cell", "begin", "length", "mode"]
    return pd.DataFrame(rows, columns=names)


def phases(changes: Sequence[tuple[float, str]], stuck: float) -> list[tuple[float, float, str]]:
    """Give begin, length and mode of the phases of one contact; the last goes on from the period's begin."""
    if not changes:
        return [(0.0, 1.0, "stick" if stuck > 0.5 else "slip")]
    times, modes = zip(*sorted(changes), strict=True)
    begins, ends, names = [0.0, *times], [*times, 1.0], [modes[-1], *modes]
    return [(begin, end - begin, mode) for begin, end, mode in zip(begins, ends, names, strict=True)]


def shown_case(rows: pd.DataFrame) -> Case | None:
    """Give the case whose stick and slip is shown: the headline's, or where contacts change most often."""
    if (rows.case == STICK_SLIP).any():
        return STICK_SLIP
    changing = rows[(rows.transitions > 0) & (rows.status == Status.PERIODIC)]
    return None if changing.empty else changing.sort_values("transitions", kind="stable").case.iloc[-1]
