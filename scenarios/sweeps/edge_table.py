"""Band edges of a dataset as a table: both of every curve, and why a curve has none."""

import json
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from multibody_xval.scenarios import edges
from multibody_xval.scenarios.compute.sources import digest
from multibody_xval.scenarios.model import REFERENCE, Case, Result, Run, Status
from multibody_xval.scenarios.result_tables import CONFIG, is_exact, points, rows_of
from multibody_xval.scenarios.ruler.exact_values import ruler
from multibody_xval.scenarios.ruler.judge import UNKNOWN
from multibody_xval.scenarios.running.evaluate import Means, computed
from multibody_xval.scenarios.store import identity
from multibody_xval.scenarios.sweeps.dataset import judged_table, sweep_in
from multibody_xval.scenarios.sweeps.plan import FREQUENCY, STEPS
from reference_lcp.errors import ParameterError

CURVE = [*CONFIG, "curve", "steps"]
"""Columns by which the edges of a curve are found."""

COMPARED = ["configuration", "exact", "error", "expected", "allowed", "verdict"]
"""Columns where there is another configuration than the reference."""

NUMBERS = (FREQUENCY, "interpolation", "exact", "exact_bar", "error", "expected", "allowed")
"""What `edges.judged_edges` gives of an edge."""


def edge_table(data: xr.Dataset, means: Means) -> pd.DataFrame:
    """Refine both edges of every curve of a dataset, or of a part of one.

    Returns
    -------
    DataFrame
        A row an edge: the axes of the sweep, ``edge``, ``frequency_ratio`` and ``error_bar`` (how far from it the exact
        motion's edge may be); where there are other configurations than the reference, `COMPARED`; ``reason``, why
        there is no such edge.

    Raises
    ------
    ParameterError
        If the data are of something else than a sweep, or of another version of an engine than is installed.
    """
    table = judged_table(data)
    _check_versions(table)
    axes = [name for name in sweep_in(data).axes if name != FREQUENCY]
    known = _known(table, data.attrs.get("configurations", "{}"))
    found = []
    for _, own in table.groupby(STEPS if STEPS in axes else lambda _row: 0, sort=False):
        stored = computed(_first_runs(own), means, then=[("band edges", edges.propose)], known=known)
        known |= {row.run: row.result for row in stored}
        found.append(_edges(points(stored), own, axes))
    return _shown(pd.concat(found, ignore_index=True), axes)


def _check_versions(table: pd.DataFrame) -> None:
    """Refuse to refine the curve of one version of an engine with another one."""
    for config, version in dict.fromkeys(rows_of(table, "config", "version")):
        installed = identity(config)[0]
        if version != installed:
            problem = f"the data are of {config.engine} {version}, and {installed or 'none'} is installed"
            raise ParameterError(f"{problem}; allowed: the same version, or data.sel(...) without {config}")


def _runs(table: pd.DataFrame) -> list[Run]:
    return [Run(*own) for own in rows_of(table, "config", "case", "steps")]


def _first_runs(table: pd.DataFrame) -> list[Run]:
    """Give the runs of points, and those of the ruler there."""
    own = _runs(table)
    return list(dict.fromkeys([*own, *ruler((run.of(Case), run.steps) for run in own)]))


def _known(table: pd.DataFrame, identities: str) -> dict[Run, Result]:
    """Give the results that the data hold, where the same code would give them again."""
    try:
        noted: Any = json.loads(identities)
        same = {own for own in set(table.config) if noted[str(own)]["sources"] == digest(own.engine)}
    except (ValueError, LookupError, TypeError):
        return {}
    own = table[table.config.isin(same)]
    return {run: _result(row) for run, (_, row) in zip(_runs(own), own.iterrows(), strict=True)}


def _result(row: pd.Series) -> Result:
    own: dict[str, Any] = {
        name: row[name] for name in ("amplification", "stuck", "stick_velocity", "seconds", "reason")
    }
    own |= {name: int(row[name]) for name in ("periods", "multiple")}
    return Result(status=Status(row.status), transmittance=row.ratio, residual=row.residual, **own)


def _edges(rows: pd.DataFrame, asked: pd.DataFrame, axes: list[str]) -> pd.DataFrame:
    """Give both edges of every curve that is asked for, and why it has none."""
    curves = asked.drop_duplicates(CURVE)[list(dict.fromkeys(["config", *CURVE, *axes]))]
    both = curves.merge(pd.DataFrame({"edge": edges.EDGES}), how="cross")
    found = edges.judged_edges(rows)[[*CURVE, "edge", *NUMBERS, "verdict", "absent"]]
    rows = both.merge(found, on=[*CURVE, "edge"], how="left").rename(columns={"absent": "reason"})
    few = f"fewer than {edges.FEWEST_POINTS} points: too few to say"
    of_exact = "the exact motion's edges are in the column exact of other configurations"
    reason = rows.reason.fillna(pd.Series(np.where(is_exact(rows), of_exact, few), rows.index))
    return rows.assign(reason=reason, verdict=rows.verdict.fillna(UNKNOWN))


def _shown(found: pd.DataFrame, axes: list[str]) -> pd.DataFrame:
    """Give the columns that people read, by case, edge and configuration."""
    bar = found.error.abs() + found.exact_bar + found.interpolation
    names = [*axes, "edge", FREQUENCY, "error_bar"]
    if set(found.config) - {REFERENCE}:
        names += COMPARED
    own = found.assign(error_bar=bar, configuration=found.config.map(str))
    order = own.sort_values([*axes, "edge"], kind="stable")
    return order[[*names, "reason"]].reset_index(drop=True)
