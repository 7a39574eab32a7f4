"""What has come out, in one sentence, and why a command fails."""

from collections.abc import Callable

import pandas as pd

from multibody_xval.reports.formatting import significant
from multibody_xval.reports.page.tables import at_headline
from multibody_xval.scenarios.ruler.judge import AGREES, DEVIATES, failures
from multibody_xval.scenarios.studies.claims import TITLES

NAMED_AT_MOST = 4
"""Configurations that the sentence names; of more, their number."""


def finding(rows: pd.DataFrame) -> str:
    """Say in one sentence what has come out of planned points of engines, as `tables.labelled` names them."""
    rows = rows[rows.verdict != "unsupported"]
    own = rows[rows.judged]
    if rows.empty:
        return "Nothing was compared: there are no results of engines."
    if own.empty:
        return f"Nothing was judged, errors were measured: {_largest(rows)}."
    off = own.groupby("configuration", sort=False).verdict.transform(lambda verdicts: (verdicts == DEVIATES).any())
    parts = [_judged(one, deviates=deviates) for deviates, one in own.groupby(off, sort=True)]
    default = rows[(rows.options == TITLES["default"]) & ~rows.judged & rows.error_db.notna()]
    deep = at_headline(default)
    if not default.empty:
        size = _largest(default if deep.empty else deep)
        parts.append(f"with default options, vibration amplitudes are wrong by up to {size}")
    text = "; ".join(parts)
    return f"{text[0].upper()}{text[1:]}."


def _judged(rows: pd.DataFrame, *, deviates: bool) -> str:
    """Say of configurations, all of which deviate somewhere or none of which does, how many of their numbers do."""
    names = [_name(str(options), own) for options, own in rows.groupby("options", sort=False)]
    several = "s" * (rows.configuration.nunique() == 1)
    if not deviates:
        agreeing = int((rows.verdict == AGREES).sum())
        count = f"{agreeing:,} of {len(rows):,} simulations" if agreeing < len(rows) else _all_of(len(rows))
        return f"{' and '.join(names)} agree{several} with the exact motion in {count}" + (
            f" and deviate{several} in none" * (agreeing < len(rows))
        )
    off = rows[rows.verdict == DEVIATES]
    size = f"up to {significant(off.error_percent.max())} % of the amplitude"
    return f"{' and '.join(names)} deviate{several} in {len(off):,} of {len(rows):,} simulations, by {size}"


def _all_of(count: int) -> str:
    return f"all {count:,} simulations" if count > 1 else "the only simulation"


def _name(options: str, rows: pd.DataFrame) -> str:
    """Name configurations of one preset: ``tuned to the chain, MuJoCo (joint, contact) and PyBullet (joint)``."""
    parts = rows.title.drop_duplicates().str.partition(", joint")[0].str.partition(", contact")[0]
    engines = dict.fromkeys(parts)
    if len(engines) > NAMED_AT_MOST:
        return f"{options}, {rows.configuration.nunique()} configurations"
    titles = rows.title.unique()
    listed = [
        f"{name} ({', '.join(own[len(name) + 2 :] for own in titles if own.startswith(f'{name}, '))})"
        for name in engines
    ]
    return f"{options}, {' and '.join([', '.join(listed[:-1]), listed[-1]] if listed[:-1] else listed)}"


def _largest(rows: pd.DataFrame) -> str:
    """Give the largest error of a level, and whose it is."""
    sizes = rows.error_db.abs()
    if sizes.isna().all():
        return "none is known"
    worst = rows.assign(size=sizes).sort_values("size", na_position="first").iloc[-1]
    return f"{significant(sizes.max())} dB ({worst.title})"


def reasons_to_fail(
    rows: pd.DataFrame, edges: pd.DataFrame, named: Callable[[pd.DataFrame], pd.Series] | None = None
) -> list[str]:
    """Say why a report fails, a line a configuration: by its points (see `judge.failures`), or by its band edges."""
    lines = failures(rows, named)
    if not edges.empty:
        own = edges[edges.judged.fillna(False).astype(bool)]
        for name, found in own.groupby("configuration", sort=False):
            off = found[found.verdict == DEVIATES]
            if len(off):
                worst = significant((off.frequency_ratio - off.exact).abs().max())
                lines.append(
                    f"{name}: {len(off)} of {len(found)} band edges deviate, by up to {worst} in frequency ratio"
                )
    return lines
