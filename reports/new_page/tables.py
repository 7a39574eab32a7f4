"""Tables of the page: functions of judged points."""

from collections.abc import Iterable

import pandas as pd

from multibody_xval.scenarios.judge import VERDICTS
from multibody_xval.scenarios.report_plan import HEADLINE, HEADLINE_STEPS, PRESETS
from multibody_xval.scenarios.result_tables import CONFIG, is_reference
from multibody_xval.scenarios.store import Stored

HEADLINE_COLUMNS = ["engine", "formulation", *PRESETS]


def at_headline(points: pd.DataFrame) -> pd.DataFrame:
    """Give the rows at the headline's points."""
    return points[points.case.isin(HEADLINE) & (points.steps == HEADLINE_STEPS) & ~is_reference(points)]


def largest_errors(points: pd.DataFrame) -> pd.DataFrame:
    """Give, of every configuration, the largest error in dB and how many of its points are periodic."""
    own = points.assign(size=points.error_db.abs(), periodic=points.status == "periodic")
    groups = own.groupby(CONFIG, sort=False)
    return groups.agg(error_db=("size", "max"), points=("size", "size"), periodic=("periodic", "sum")).reset_index()


def error_text(error_db: float, points: int, periodic: int) -> str:
    """Give an error for people: with a star where some points are not periodic, in words where two in three are not."""
    if 3 * periodic <= points:
        return "not periodic"
    return f"{error_db:.2g}{'' if periodic == points else '*'}"


def headline(points: pd.DataFrame) -> pd.DataFrame:
    """Give the largest error at the headline's points: a row an engine and formulation, a column a preset."""
    worst = largest_errors(at_headline(points))
    if worst.empty:
        return pd.DataFrame(columns=HEADLINE_COLUMNS)
    numbers = zip(worst.error_db, worst.points, worst.periodic, strict=True)
    worst = worst.assign(text=[error_text(*own) for own in numbers])
    wide = worst.pivot(index=["engine", "formulation"], columns="preset", values="text")
    return wide.reindex(columns=PRESETS).fillna("–").reset_index().rename_axis(columns=None)


def verdict_counts(points: pd.DataFrame) -> pd.DataFrame:
    """Count the verdicts of every configuration; `judged` says whether they decide the exit code."""
    own = points[~is_reference(points)]
    counts = own.groupby(["configuration", "judged"], sort=False).verdict.value_counts().unstack(fill_value=0)
    return counts.reindex(columns=[name for name in VERDICTS if name in counts]).reset_index().rename_axis(columns=None)


def error_map(points: pd.DataFrame) -> pd.DataFrame:
    """Give the largest error in dB of judged configurations at every friction and frequency ratio."""
    own = points[points.judged & ~is_reference(points)]
    sizes = own.assign(error_db=own.error_db.abs()).groupby(["friction_ratio", "frequency_ratio"]).error_db.max()
    return sizes.reset_index()


def edge_table(edges: pd.DataFrame) -> pd.DataFrame:
    """Give the edges as the page shows them."""
    own = edges.assign(friction_ratio=[case.friction_ratio for case in edges.curve])
    names = [*CONFIG, "friction_ratio", "edge", "frequency_ratio", "exact", "error", "allowed", "verdict"]
    return own[names].reset_index(drop=True)


def engines(stored: Iterable[Stored]) -> pd.DataFrame:
    """Give the version of every engine, and the options of each configuration that differ from the engine's own."""
    rows = {(run.config, version) for run, version, _ in stored}
    shown = [
        (
            str(own),
            version,
            ", ".join(
                f"{name} = {option.value!r}"
                for name, option in own.preset.options.items()
                if option.value != option.default
            ),
        )
        for own, version in sorted(rows, key=str)
    ]
    return pd.DataFrame(shown, columns=["configuration", "version", "changed options"])
