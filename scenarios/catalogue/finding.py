"""What numbers of scenarios say: the worst case of each quantity, why a command fails, and all in one sentence."""

from collections.abc import Callable, Sequence

import numpy as np
import pandas as pd

from multibody_xval.scenarios.catalogue.numbers import NOT_RUN
from multibody_xval.scenarios.ruler.judge import AGREES, DEVIATES, TOO_LARGE, UNKNOWN, failures

ONE = ["scenario", "configuration", "quantity"]
"""Columns that the cases of one number of one configuration share."""

WORST_FIRST = (DEVIATES, "failed", "not periodic", NOT_RUN, UNKNOWN, TOO_LARGE, "unsupported", AGREES)

MOST_NAMED = 3
"""Configurations and reasons that the sentence names; of more, their number."""


def over_allowed(rows: pd.DataFrame) -> "pd.Series[float]":
    """Give how far numbers are from what is expected, over what is allowed."""
    far, allowed = rows.distance.astype(float), rows.allowed.astype(float)
    return pd.Series(np.where(far > 0, far / allowed.where(allowed > 0, 0.0), 0.0 * far), rows.index)


def worst_cases(rows: pd.DataFrame) -> pd.DataFrame:
    """Give the worst case of every number of every configuration.

    Added columns: ``times``, its distance over what is allowed; ``cases``, how many there are, and ``alike``, how many
    have its verdict.
    """
    place = rows.verdict.map(WORST_FIRST.index)
    own = rows.assign(
        times=over_allowed(rows),
        cases=rows.groupby(ONE, sort=False).verdict.transform("size"),
        alike=rows.groupby([*ONE, "verdict"], sort=False).verdict.transform("size"),
    )
    order = own.assign(place=place, size=-own.times.fillna(-1.0)).sort_values(["place", "size"], kind="stable")
    first = order.drop_duplicates(ONE).set_index(ONE, drop=False)
    return first.loc[list(rows[ONE].drop_duplicates().itertuples(index=False, name=None)), own.columns].reset_index(
        drop=True
    )


def counts(rows: pd.DataFrame) -> str:
    """Count verdicts in words, such as ``18 agree, 2 deviate``."""
    words = {AGREES: "agree", DEVIATES: "deviate", TOO_LARGE: "with too large a time step"}
    found = rows.verdict.value_counts()
    parts = [f"{found[name]} {words.get(name, name)}" for name in (AGREES, *WORST_FIRST[:-1]) if name in found]
    return ", ".join(parts)


def reasons_to_fail(rows: pd.DataFrame, *, named: bool) -> list[str]:
    """Say why a command fails, a line a scenario and configuration; see `judge.failures`.

    `named`: the configurations are named by the user, so that all fail whose engine fails too often.
    """
    every: Callable[[pd.DataFrame], pd.Series] | None = (lambda own: own.judged | True) if named else None
    several = rows.scenario.nunique() > 1
    return [
        f"{name}, {line}" if several else line
        for name, own in rows.groupby("scenario", sort=False)
        for line in failures(own, every, _by)
    ]


def _by(off: pd.DataFrame) -> str:
    times = float(over_allowed(off).max())
    quantity, case = off[["quantity", "case"]].to_numpy()[over_allowed(off).argmax()]
    size = "any amount, where nothing is allowed"
    if np.isfinite(times):
        size = f"{float(f'{times:.2g}'):,g} times what is allowed"
    return f"{size} ({quantity}; {case})"


def conclusion(rows: pd.DataFrame, reasons: Sequence[str]) -> str:
    """Say in one sentence what has come out."""
    compared = rows[rows.verdict != "unsupported"]
    if compared.empty:
        return "Nothing was compared: none of these configurations supports what was asked."
    if reasons:
        rest = len(reasons) - MOST_NAMED
        text = "; ".join(reasons[:MOST_NAMED]) + (f"; and {rest} more" if rest > 0 else "")
        return f"It fails: {text}."
    own = compared[compared.judged]
    if own.empty:
        return f"Nothing was judged, errors were measured: of {len(rows)} numbers {counts(rows)}."
    names = own.configuration.unique()
    who = " and ".join(names) if len(names) <= MOST_NAMED else f"{len(names)} judged configurations"
    agreeing = int((own.verdict == AGREES).sum())
    one = "s" * (len(names) == 1)
    if agreeing == len(own):
        every = f"all {len(own)} numbers" if len(own) > 1 else "the only number"
        return f"{who} agree{one} with what is expected in {every}."
    other = f"{agreeing} of {len(own)} numbers, and deviate{one} in none ({counts(own[own.verdict != AGREES])})"
    return f"{who} agree{one} with what is expected in {other}."
