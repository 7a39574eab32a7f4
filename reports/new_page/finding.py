"""What has come out, in one sentence, and why a command fails."""

from collections.abc import Callable

import pandas as pd

from multibody_xval.reports.new_page.tables import TITLES
from multibody_xval.scenarios.edges import DEVIATES as EDGE_DEVIATES
from multibody_xval.scenarios.judge import AGREES, DEVIATES, failures

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
    groups = [(_name(one), one) for _, one in own.groupby("configuration", sort=False)]
    good = [name for name, one in groups if not (one.verdict == DEVIATES).any()]
    silent = len(own) - int(own.verdict.isin([AGREES, DEVIATES]).sum())
    parts = []
    if good:
        agreeing = sum(int((one.verdict == AGREES).sum()) for name, one in groups if name in good)
        parts.append(f"{_listed(good, 'configurations')} agree{'s' * (len(good) == 1)} with the exact motion at "
                     f"{agreeing:,} operating points and nowhere deviate{'s' * (len(good) == 1)}")  # fmt: skip
    parts += [_off(name, one) for name, one in groups if name not in good]
    if silent:
        parts.append(f"{silent:,} of {len(own):,} points have no verdict")
    default = rows[(rows.options == TITLES["default"]) & ~rows.judged & rows.error_db.notna()]
    if not default.empty:
        parts.append(f"with default options, vibration amplitudes are wrong by up to {_largest(default)}")
    text = "; ".join(parts)
    return f"{text[0].upper()}{text[1:]}."


def _off(name: str, rows: pd.DataFrame) -> str:
    off = rows[rows.verdict == DEVIATES]
    return f"{name} deviates at {len(off):,} of {len(rows):,}, by up to {off.error_percent.max():.2g} % of the amplitude"


def _largest(rows: pd.DataFrame) -> str:
    """Give the largest error of a level, and whose it is."""
    sizes = rows.error_db.abs()
    if sizes.isna().all():
        return "none is known"
    worst = rows.loc[sizes.idxmax()]
    return f"{sizes.max():.2g} dB ({worst.title})"


def _name(rows: pd.DataFrame) -> str:
    return f"{rows.title.iloc[0]}, {rows.options.iloc[0]}"


def _listed(names: list[str], what: str) -> str:
    if len(names) > NAMED_AT_MOST:
        return f"{len(names)} {what}"
    return " and ".join([", ".join(names[:-1]), names[-1]] if names[:-1] else names)


def reasons_to_fail(
    rows: pd.DataFrame, edges: pd.DataFrame, named: Callable[[pd.DataFrame], pd.Series] | None = None
) -> list[str]:
    """Say why a report fails, a line a configuration: by its points (see `judge.failures`), or by its band edges."""
    lines = failures(rows, named)
    if not edges.empty:
        own = edges[edges.judged.fillna(False).astype(bool)]
        for name, found in own.groupby("configuration", sort=False):
            off = found[found.verdict == EDGE_DEVIATES]
            if len(off):
                worst = (off.frequency_ratio - off.exact).abs().max()
                lines.append(f"{name}: {len(off)} of {len(found)} band edges deviate, by up to {worst:.2g} in frequency ratio")
    return lines
