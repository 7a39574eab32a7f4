"""The worst number of each scene of each engine, with default options and with the recipe."""

import math

import pandas as pd

from multibody_xval.engines.interface.variant import GENERAL
from multibody_xval.scenarios.catalogue.scenario import OWN_STEP
from multibody_xval.scenarios.ruler.judge import OTHER_SCHEMES

NEVER, FAILED, NONE = math.inf, -math.inf, math.nan
"""Numbers of what never happens, of a scene that an engine fails at, and of one that it has none of."""

NOT_CURED = "not cured"
"""Said of numbers that are far beyond what is allowed with the recipe too."""

LEAST_PRINTED = 5e-3
"""Smaller numbers are printed as zero: far below the resolution of every quantity."""

THOUSANDS = 100.0
"""From here on numbers are printed without decimals."""


def worst_numbers(table: pd.DataFrame) -> pd.DataFrame:
    """Give the worst number of each scene of each engine, at its own time step.

    Parameters
    ----------
    table
        Numbers of scenes; see `multibody_xval.scenarios.catalogue.numbers`.

    Returns
    -------
    pandas.DataFrame
        Rows: engine and number, such as ``slope-hold, drift [µm/s]``; columns ``default`` and ``recommended``: the
        number that is largest in size, `NEVER`, `FAILED`, or NaN where the engine has no such scene; ``cured``: whether
        none is more than `OTHER_SCHEMES` times what is allowed with the recipe.
    """
    own = table[table.preset.isin(GENERAL) & ~table.case.str.contains("may sleep")]
    at_own = own.case.str.endswith(OWN_STEP)
    rows = own[at_own | ~own.engine.isin(own.engine[at_own])]
    rows = rows.assign(
        what=rows.scenario + ", " + rows.quantity + " [" + rows.unit + "]",
        number=rows.value.astype(float).mask(rows.verdict == "failed", FAILED),
    )
    worst = rows.groupby(["engine", "what", "preset"], sort=False).number.apply(_worst).unstack("preset")
    far = rows.distance.astype(float) > OTHER_SCHEMES * rows.allowed.astype(float)
    beyond = rows[(far | (rows.verdict == "failed")) & (rows.preset == GENERAL[-1])]
    off = worst.index.isin(beyond.set_index(["engine", "what"]).index)
    return worst.reindex(columns=list(GENERAL)).assign(cured=~off)


def _worst(values: "pd.Series[float]") -> float:
    """Give the value that is largest in size; NaN where there is none."""
    return max(values.dropna(), key=abs, default=NONE)


def with_recipe(value: float, *, cured: bool) -> str:
    """Write a number with the recipe for people, and say where that does not cure."""
    return printed_number(value) + f" ({NOT_CURED})" * (not cured)


def printed_number(value: float) -> str:
    """Write a number of a scene for people."""
    if math.isnan(value):
        return "–"
    if math.isinf(value):
        return "never" if value == NEVER else "failed"
    size = abs(value)
    return "0" if size < LEAST_PRINTED else f"{value:,.0f}" if size >= THOUSANDS else f"{value:.2g}"
