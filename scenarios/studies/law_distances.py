"""How far engines are from what their presets say that they step by: a law, or the reference's scheme."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import pandas as pd

from multibody_xval.engines.interface.law import Law, NotModelled
from multibody_xval.engines.shared.law_distance import (
    allowed_distance,
    distance_from_law,
    figure3_lanes,
    stepped_by,
    unclaimed_reason,
)
from multibody_xval.scenarios.compute import SECONDS_A_RUN
from multibody_xval.scenarios.compute.checked import CheckedSimulation
from multibody_xval.scenarios.model import REFERENCE, Config
from multibody_xval.scenarios.result_tables import CONFIG, full_name
from multibody_xval.scenarios.running.pool import preparation_seconds, reason_of
from multibody_xval.scenarios.running.processes import GRACE, Pool, local
from multibody_xval.scenarios.store import identity
from multibody_xval.scenarios.table_text import number_texts
from reference_lcp.defaults import MINIMUM_STEPS_PER_PERIOD

LEGEND = f"""\
How well does the law of each preset predict its engine? A *law* is a model of the steps of a preset. It explains an
error, and excuses none. Engine and law start from the same state, at {len(figure3_lanes())} points of Figure 3, with
{MINIMUM_STEPS_PER_PERIOD} steps per period; positions are compared over one period.

| column | what it is |
|---|---|
| *steps by* | what the preset says that its steps are: the reference's scheme, or a law |
| *largest*, *median* | distance of engine and law after one period, over U0 |
| *allowed* | what the contract of engines allows |
| *points* | points at which the law claims to hold |
| *not measured* | why no law predicts the steps, or what failed |
"""

HEADINGS = {
    "configuration": "configuration", "steps_by": "steps by", "largest": "largest [U0]", "median": "median",
    "allowed": "allowed", "points": "points", "reason": "not measured",
}  # fmt: skip
"""Columns of the table, with their headings for people."""


def law_distances(configs: Iterable[Config]) -> pd.DataFrame:
    """Give one row a configuration of other engines than the reference; what crashes or hangs is the row's reason.

    Columns: ``configuration``, those of `CONFIG`, ``version``, ``steps_by``, ``formula``, ``constants``, ``largest``
    and ``median`` distance from the law after a period over U0, ``allowed``, ``points`` and ``reason``.
    """
    with local(1) as pool:
        rows = [_row(config, pool) for config in configs if config.engine != REFERENCE.engine]
    columns = [
        "configuration", *CONFIG, "version", "steps_by", "formula", "constants", "largest", "median", "allowed",
        "points", "reason",
    ]  # fmt: skip
    return pd.DataFrame(rows, columns=columns)


def _row(config: Config, pool: Pool) -> dict[str, Any]:
    stated = config.preset.stated_law()
    labels = dict(zip(CONFIG, (config.engine, str(config.formulation), config.preset_name), strict=True))
    row: dict[str, Any] = {
        "configuration": full_name(config),
        **labels,
        "version": identity(config)[0],
        "steps_by": "neither",
    }
    row |= {"formula": "", "constants": "", "points": 0}
    if isinstance(stated, Law):
        numbers = (f"{name} = {each.value:g} {each.unit}".strip() for name, each in stated.constants.items())
        row |= {"steps_by": "a law", "formula": stated.formula, "constants": ", ".join(numbers)}
    elif config.preset.shares_scheme:
        row["steps_by"] = "the reference's scheme"
    if stepped_by(config) is None:
        return row | {"reason": stated.reason if isinstance(stated, NotModelled) else "nothing is stated"}
    limit = preparation_seconds(config) + SECONDS_A_RUN
    try:
        found = pool.submit((period_distances, [config], limit, config.capabilities.package)).result(limit + GRACE)
    except Exception as problem:  # an engine may raise anything, or end its process
        return row | {"reason": reason_of(problem)}
    sizes = {"largest": max(found, default=np.nan), "median": float(np.median(found)) if found else np.nan}
    return row | sizes | {"allowed": allowed_distance(config), "points": len(found), "reason": ""}


def period_distances(config: Config) -> list[float]:
    """Give the distances after one period, over U0, at every point at which the law claims to hold."""
    law, steps = stepped_by(config), MINIMUM_STEPS_PER_PERIOD
    assert law is not None, "something is stated"
    lanes = [lane for lane in figure3_lanes() if unclaimed_reason(law, lane) is None]
    return [distance_from_law(CheckedSimulation(config.build([lane])), law, lane, steps).law for lane in lanes]


def shown(table: pd.DataFrame) -> pd.DataFrame:
    """Give the table for people."""
    texts = number_texts(table, {"largest": "{:.1e}", "median": "{:.1e}", "allowed": "{:.0e}"})
    return texts[[*HEADINGS]].rename(columns=HEADINGS)


def formulas(table: pd.DataFrame) -> list[str]:
    """Give the formula of every law, with its constants, in a line."""
    rows = table[table.formula != ""]
    lines = zip(rows.configuration, rows.formula, rows.constants, strict=True)
    return [f"{name}: {formula}{f'; {constants}' if constants else ''}" for name, formula, constants in lines]
