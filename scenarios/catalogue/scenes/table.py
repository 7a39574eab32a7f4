"""Engines by scenes: the worst number of each scene, as installed and with the recipe."""

import math

import numpy as np
import pandas as pd

from multibody_xval.engines.interface.variant import GENERAL
from multibody_xval.scenarios.catalogue.scenes.base import OWN_STEP
from multibody_xval.scenarios.verdicts.finding import Verdict

FAILED, NONE = math.inf, math.nan
"""Numbers of a scene that an engine fails at, and of one that it has none of."""


def worst_numbers(findings: pd.DataFrame) -> pd.DataFrame:
    """Give the worst number of each scene of each engine, at its own step.

    Parameters
    ----------
    findings
        Table of findings, as `multibody_xval.check` gives it or ``run --out`` writes it.

    Returns
    -------
    pandas.DataFrame
        Rows: engine and number, such as ``slope-hold, creep [µm/s]``; columns ``default`` and ``recommended``: the
        number that is farthest from what is expected; infinite where the engine failed, NaN where it has no such scene.
    """
    own = findings[findings.preset.isin(GENERAL) & ~findings.case.str.contains("may sleep")]
    at_own = own.case.str.endswith(OWN_STEP) | ~own.engine.isin(own.engine[own.case.str.endswith(OWN_STEP)])
    rows = own[at_own].assign(number=[_number(row) for row in own[at_own].itertuples()])
    numbers = rows.scenario + ", " + rows.metric + " [" + rows.unit + "]"
    worst = rows.assign(what=numbers).groupby(["engine", "what", "preset"], sort=False).number.apply(_worst)
    return worst.unstack("preset").reindex(columns=list(GENERAL))


def _number(row: object) -> float:
    """Give the value of a finding: what disagrees without one has failed."""
    value, verdict = getattr(row, "value", NONE), getattr(row, "verdict", "")
    return FAILED if verdict == Verdict.DISAGREE and not np.isfinite(value) else float(value)


def _worst(values: "pd.Series[float]") -> float:
    """Give the value that is largest in size; NaN where there is none."""
    return max(values.dropna(), key=abs, default=NONE)


def printed_number(value: float) -> str:
    """Write a number of a scene for people."""
    if math.isnan(value):
        return "–"
    if math.isinf(value):
        return "failed"
    size = abs(value)
    return "0" if size < LEAST_PRINTED else f"{value:,.0f}" if size >= THOUSANDS else f"{value:.2g}"


LEAST_PRINTED = 5e-3
"""Smaller numbers are printed as zero: far below the resolution of every metric."""

THOUSANDS = 100.0
"""From here on numbers are printed without decimals."""


def scene_table(findings: pd.DataFrame) -> pd.DataFrame:
    """Give engines × numbers for people: as installed → recommended, or one where both are the same text."""
    worst = worst_numbers(findings)
    texts = [_change(*map(printed_number, row)) for row in worst.to_numpy()]
    table = pd.Series(texts, worst.index, dtype=object).unstack("what", fill_value="–")
    numbers = list(dict.fromkeys(worst.index.get_level_values("what")))
    scenes = {number.split(", ")[0] for number in numbers}
    names = {number: number.split(", ", 1)[1] for number in numbers} if len(scenes) == 1 else {}
    return table[numbers].rename(columns=names).rename_axis(None, axis=1).reset_index()


def _change(before: str, after: str) -> str:
    return before if after in (before, "–") else f"{before} → {after}"
