"""Band edges of a dataset as a table: both of every curve, and why a curve has none."""

import json
from typing import Any

import pandas as pd
import xarray as xr

from multibody_xval.scenarios import edges
from multibody_xval.scenarios.compute.sources import digest
from multibody_xval.scenarios.model import REFERENCE, Case, Result, Run, Status
from multibody_xval.scenarios.result_tables import CONFIG, points, rows_of
from multibody_xval.scenarios.ruler.exact_values import ruler
from multibody_xval.scenarios.ruler.judge import UNKNOWN
from multibody_xval.scenarios.running.evaluate import Means, computed
from multibody_xval.scenarios.store import identity
from multibody_xval.scenarios.sweeps.dataset import judged_table, sweep_in
from multibody_xval.scenarios.sweeps.plan import FREQUENCY, STEPS
from reference_lcp.errors import ParameterError

CURVE = [*CONFIG, "curve", "steps"]
"""Columns by which the edges of a curve are found."""

SMALL_PEAK_DB = 1.0
"""Height of a peak over the threshold below which an edge has a note: an amplitude that is off by 12 %, as with another
damping, moves such an edge to another peak."""

NUMBERS = (FREQUENCY, "peak", "exact", "exact_bar", "error", "expected", "allowed")
"""What `edges.judged_edges` gives of an edge."""


def edge_table(data: xr.Dataset, means: Means) -> pd.DataFrame:
    """Refine both edges of every curve of a dataset, or of a part of one.

    Returns
    -------
    DataFrame
        A row an edge, see `multibody_xval.band_edges`. Where a terminal is narrow pandas leaves out columns in the
        middle: the first and the last ones are those that are cited.

    Raises
    ------
    ParameterError
        If the data are of something else than a sweep, of none of its points, or of another version of an engine than
        is installed.
    """
    table = judged_table(data)
    if table.empty:
        raise ParameterError("the data have 0 points; allowed: at least one")
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
    rows = both.merge(found, on=[*CURVE, "edge"], how="left")
    why = rows.absent.fillna(f"fewer than {edges.FEWEST_POINTS} points: too few to say")
    return rows.assign(note=why.where(why != "", rows.peak.map(_of_peak)), verdict=rows.verdict.fillna(UNKNOWN))


def _of_peak(height: float) -> str:
    """Say that an edge depends on a small peak; nothing of other edges."""
    return f"last peak only {height:.2g} dB above 0 dB" if height < SMALL_PEAK_DB else ""


def _shown(found: pd.DataFrame, axes: list[str]) -> pd.DataFrame:
    """Give the columns that people read, by case, edge and configuration."""
    compared = bool(set(found.config) - {REFERENCE})
    names = [*axes, *["configuration"] * compared, "edge", FREQUENCY, "note"]
    names += [*["expected", "allowed", "verdict"] * compared, "error", "exact", "exact_bar"]
    own = found.assign(configuration=found.config.map(str))
    return own.sort_values([*axes, "edge"], kind="stable")[names].reset_index(drop=True)
