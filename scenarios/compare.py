"""What two tables of judged points have in common, and where the second is closer to the exact motion or farther."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from multibody_xval.scenarios.evaluate import Means, computed
from multibody_xval.scenarios.judge import FLOOR, judged, resolution
from multibody_xval.scenarios.model import Config
from multibody_xval.scenarios.plan import compared_configs, guard_cases, runs_at
from multibody_xval.scenarios.result_tables import points
from reference_lcp.errors import ParameterError

IMPROVED, REGRESSED, UNCHANGED, MISSING, UNKNOWN = "improved", "regressed", "unchanged", "missing", "unknown"

CHANGES = (REGRESSED, MISSING, IMPROVED, UNCHANGED, UNKNOWN)
"""What a point may have become, the worst first; unknown where it has changed and there is no exact value."""

LEAST_PERCENT = 0.01
"""Change of the error that counts as none [% of amplitude]: a thousandth of a decibel, far below any step."""

RANKS = {"periodic": 0, "not periodic": 1, "failed": 2, "unsupported": 3}
"""How little a run says."""

_NUMBERS = [
    "status",
    "reason",
    "transmittance_db",
    "phase_deg",
    "ratio",
    "error_db",
    "error_deg",
    "error_percent",
    "open",
]


def changes_between(before: str, now: str, means: Means) -> pd.DataFrame:
    """Compute two configurations, or the presets of two engines, at 24 points, and compare them.

    Raises
    ------
    ParameterError
        If a name is unknown, an engine not installed, or the two have no formulation and preset in common.
    """
    found = pairs(compared_configs(before), compared_configs(now))
    if not found:
        raise ParameterError(f"{before} and {now} have no formulation and preset in common; allowed: two that have")
    configs = [config for pair in found for config in pair]
    table = judged(points(computed(runs_at(configs, guard_cases()), means, f"{before} and {now}")))
    changes = [
        compared(table[table.config == one], table[table.config == other], f"{one} -> {other}") for one, other in found
    ]
    return pd.concat(changes, ignore_index=True)


def compared(before: pd.DataFrame, now: pd.DataFrame, pair: str) -> pd.DataFrame:
    """Join two tables of `judge.judged` points on the case and the number of steps.

    Returns
    -------
    DataFrame
        One row a case: ``pair``, ``case``, ``steps``, the numbers of both with the endings ``_before`` and ``_now``,
        and ``change``, one of `CHANGES`, by the error to the exact value.
    """
    one, other = (_opened(table)[["case", "steps", *_NUMBERS]] for table in (before, now))
    rows = one.merge(other, on=["case", "steps"], how="inner", suffixes=("_before", "_now"))
    return rows.assign(pair=pair, change=_changes(rows))


def _opened(table: pd.DataFrame) -> pd.DataFrame:
    """Add what each point leaves open of its error: what repeats, rounding and contacts that give way leave [%]."""
    return table.assign(open=100 * resolution(table) / table.exact.abs().clip(lower=FLOOR))


def _changes(rows: pd.DataFrame) -> np.ndarray:
    """Say what has become of each row."""
    worse = rows.status_now.map(RANKS) - rows.status_before.map(RANKS)
    left = (rows.open_before + rows.open_now).clip(lower=LEAST_PERCENT).fillna(LEAST_PERCENT)
    moved = 100 * (rows.ratio_now - rows.ratio_before).abs() / rows.ratio_before.abs() > left
    farther = rows.error_percent_now - rows.error_percent_before
    return np.select(
        [worse > 0, worse < 0, rows.status_now != "periodic", ~moved, farther.isna(), farther > left, farther < -left],
        [MISSING, IMPROVED, UNCHANGED, UNCHANGED, UNKNOWN, REGRESSED, IMPROVED],
        UNCHANGED,
    )


def summary(changes: pd.DataFrame) -> pd.DataFrame:
    """Count what has become of points, a row a pair, with the largest error before and now [% of amplitude]."""
    counts = changes.groupby("pair", sort=False).change.value_counts().unstack(fill_value=0)
    worst = changes.groupby("pair", sort=False)[["error_percent_before", "error_percent_now"]].max()
    worst.columns = ["error before [%]", "error now [%]"]
    known = [name for name in CHANGES if name in counts]
    size = changes.groupby("pair", sort=False).size().rename("points")
    return pd.concat([size, counts[known], worst], axis=1).reset_index()


def fails(changes: pd.DataFrame) -> bool:
    """Whether anything has become worse, or has changed where no exact value says where to."""
    return bool(changes.change.isin([REGRESSED, MISSING, UNKNOWN]).any())


def conclusion(changes: pd.DataFrame, before: str, now: str) -> str:
    """Say in one sentence what has come out."""
    counts = changes.change.value_counts()
    parts = [f"{counts[name]} {name}" for name in CHANGES if counts.get(name, 0)]
    better = int(counts.get(IMPROVED, 0)) - sum(int(counts.get(name, 0)) for name in (REGRESSED, MISSING))
    closer = f"{now} is closer to the exact motion" if better > 0 else f"{before} is closer to the exact motion"
    verdict = "both are as far from the exact motion" if better == 0 else closer
    return f"{len(changes)} points, from {before} to {now}: {', '.join(parts)}: {verdict}."


def pairs(before: Sequence[Config], now: Sequence[Config]) -> list[tuple[Config, Config]]:
    """Give what is compared: the same formulation and preset, whatever the options, or the only two configurations."""
    if len(before) == len(now) == 1:
        return [(before[0], now[0])]
    presets = {_preset(config): config for config in now}
    return [(config, presets[_preset(config)]) for config in before if _preset(config) in presets]


def _preset(config: Config) -> tuple[str, str]:
    """Give formulation and preset of a configuration, without changed options."""
    return config.formulation, config.preset_name.partition(":")[0]
