"""How large the errors of each configuration are, over the paper's range, and how they fall with the time step."""

import math
from collections.abc import Iterable
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from multibody_xval.scenarios.model import Case, Config, Run
from multibody_xval.scenarios.plan import runs_at
from multibody_xval.scenarios.result_tables import CONFIG, full_name
from multibody_xval.scenarios.ruler.exact_values import ruler
from multibody_xval.scenarios.table_text import number_texts
from reference_lcp.defaults import STICK_SLIP_POINTS

MAP_STEPS = 800
"""Steps per period of the map."""

MAP = tuple(
    Case(friction_ratio=friction, frequency_ratio=round(0.3 + 0.1 * k, 1))
    for friction, k in product((0.1, 0.3, 0.6, 1.0), range(14))
)
"""Friction ratios of figure 3, frequency ratios from 0.3 to 1.6."""

SIX = tuple(Case(friction_ratio=friction, frequency_ratio=eta) for friction, eta in STICK_SLIP_POINTS)
"""Cases in which contacts stick and slip; the order in the time step is fitted there."""

ORDER_STEPS = (400, 800, 1600)
"""Steps per period of the six cases, through which the order is fitted."""

HEADINGS = {
    **{name: name for name in CONFIG},
    **{f"six_{steps}_db": f"six points, {steps} [dB]" for steps in ORDER_STEPS[:2]},
    "map_db": f"map, {MAP_STEPS} [dB]",
    "map_median_db": "median [dB]",
    "map_percent": "map [%]",
    "map_median_percent": "median [%]",
    "stick_velocity": "stick velocity [ω U0]",
    "order": "order",
    "periodic": "periodic",
}
"""Columns of the table, with their headings for people."""

LEGEND = f"""\
How large are the errors of each configuration? An error is the largest difference from the exact motion, over the
points at which the engine becomes periodic. The columns:

- *six points*: error of the transmittance at six points with stick and slip, with 400 and 800 steps per period;
- *map*: the same at 4 friction ratios (0.1 … 1) × 14 frequency ratios (0.3 … 1.6), with {MAP_STEPS} steps, in dB, and
  in per cent of the exact amplitude, where a difference of phase counts too; *median*: of the map;
- *stick velocity*: largest velocity within a stick, over ω U0;
- *order*: order of the error in the time step, from {", ".join(map(str, ORDER_STEPS))} steps;
- *periodic*: points at which the motion becomes periodic.
"""


def map_runs(configs: Iterable[Config]) -> list[Run]:
    """Give the runs of configurations on the map and at the six points, and those of the ruler there."""
    configs = list(dict.fromkeys(configs))
    runs = runs_at(configs, MAP, MAP_STEPS)
    places = list(product(SIX, ORDER_STEPS))
    runs += [Run(config, case, steps) for config in configs for case, steps in places]
    return list(dict.fromkeys([*runs, *ruler(places)]))


def accuracies(judged: pd.DataFrame) -> pd.DataFrame:
    """Give the errors of every configuration in judged points: a row a configuration.

    Columns: those of `HEADINGS` as numbers (NaN without any periodic point), ``points``, ``worst`` (the case of the
    largest error on the map, ``None`` without one) and ``reason`` (of the first run that failed).
    """
    at_six = judged.case.isin(SIX) & judged.steps.isin(ORDER_STEPS)
    on_map = judged.case.isin(MAP) & (judged.steps == MAP_STEPS)
    rows = judged[at_six | on_map].assign(on_map=on_map, at_six=at_six)
    groups = rows.groupby(CONFIG, sort=False)
    return pd.DataFrame([dict(zip(CONFIG, key, strict=True)) | _errors(own) for key, own in groups])


def _errors(rows: pd.DataFrame) -> dict[str, object]:
    """Give the numbers of one configuration."""
    size = rows.error_db.abs()
    on_map, six = size[rows.on_map], {steps: size[rows.at_six & (rows.steps == steps)] for steps in ORDER_STEPS}
    percent = rows.error_percent[rows.on_map]
    return {
        **{f"six_{steps}_db": six[steps].max() for steps in ORDER_STEPS[:2]},
        "map_db": on_map.max(), "map_median_db": on_map.median(),
        "map_percent": percent.max(), "map_median_percent": percent.median(),
        "stick_velocity": rows.stick_velocity.max(), "order": _order(list(six.values())),
        "periodic": int((rows.status == "periodic").sum()), "points": len(rows),
        "worst": next(iter(rows.case[on_map.dropna().nlargest(1).index]), None),
        "reason": first_failure(rows),
    }  # fmt: skip


def first_failure(rows: pd.DataFrame) -> str:
    """Give the reason of the first run that has no motion at all; empty without one."""
    return next(iter(rows.reason[rows.status.isin(["failed", "unsupported"])]), "")


def _order(errors: list["pd.Series[float]"]) -> float:
    """Fit the order to root mean square errors, one a number of steps; NaN unless all points are periodic."""
    if any(len(own) < len(SIX) or own.isna().any() for own in errors):
        return math.nan
    size = [math.sqrt((own**2).mean()) for own in errors]
    return float(-np.polyfit(np.log(ORDER_STEPS), np.log(size), 1)[0]) if min(size) > 0 else math.nan


def remarks(table: pd.DataFrame) -> list[str]:
    """Say where the largest error of each configuration is, what is not periodic, and why runs failed."""
    lines = []
    row: Any
    for row in table.itertuples():
        parts = []
        if row.worst is not None:
            parts.append(f"worst at ({row.worst.friction_ratio:g}, {row.worst.frequency_ratio:g})")
        if row.periodic < row.points:
            parts.append(f"{row.points - row.periodic} of {row.points} points are not periodic")
        if row.reason:
            parts.append(f"first failure: {row.reason}")
        if parts:
            lines.append(f"{full_name(Config(row.engine, row.formulation, row.preset))}: {'; '.join(parts)}")
    return lines


PATTERNS = {"order": "{:.2f}", "stick_velocity": "{:.1e}"}
"""How numbers are printed that are not errors."""


def shown(table: pd.DataFrame) -> pd.DataFrame:
    """Give the table as people read it: texts, a dash where there is no number."""
    patterns = {name: "{:.3f}" for name in HEADINGS if name not in (*CONFIG, "periodic")} | PATTERNS
    periodic = [f"{own}/{total}" for own, total in zip(table.periodic, table.points, strict=True)]
    return number_texts(table, patterns).assign(periodic=periodic)[[*HEADINGS]].rename(columns=HEADINGS)
