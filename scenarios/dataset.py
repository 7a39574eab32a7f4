"""A sweep as labelled arrays: judged points with units, options and versions, and the sweep itself; and back again."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from multibody_xval.scenarios.judge import AGREES, DEVIATES
from multibody_xval.scenarios.model import Case, Config
from multibody_xval.scenarios.result_tables import file_columns, of_config
from multibody_xval.scenarios.store import identity
from multibody_xval.scenarios.sweep_file import content_of, sweep_of
from multibody_xval.scenarios.sweep_plan import FREQUENCY, Sweep
from multibody_xval.scenarios.tables import csv_text
from reference_lcp.errors import ParameterError
from reference_lcp.output import write_whole

UNITS = {
    "transmittance_db": "dB", "phase_deg": "degree", "residual": "1", "amplification": "1", "periods": "1",
    "multiple": "1", "transitions": "1", "stick_velocity": "1", "seconds": "s", "steps": "1",
    "exact_db": "dB", "exact_deg": "degree", "exact_bar": "1", "error_db": "dB", "error_deg": "degree",
    "error_percent": "percent", "scheme_error": "1", "growth": "1", "reference_residual": "1", "distance": "1",
    "allowed": "1",
}  # fmt: skip
"""Numbers of judged points, with their units."""

COMPLEX = ("ratio", "exact", "reference")
"""Transmittances of judged points, each as a real and an imaginary part."""

TEXTS = ("status", "verdict", "expected", "exact_kind", "reason", "version")

NO_POINT = "missing"
"""Status where a sweep has no point: adaptive curves have each their own frequencies."""


def dataset(sweep: Sweep, table: pd.DataFrame) -> xr.Dataset:
    """Give the judged points of a sweep as labelled arrays: dimensions ``configuration`` and the axes of the sweep."""
    own = sweep.own_points(table)
    names = own.config.map(str)
    parts = {f"{name}_{part}": getattr(np, part)(own[name]) for name in COMPLEX for part in ("real", "imag")}
    stuck = own.stuck.map(lambda values: json.dumps(list(values)))
    plain = own[[*UNITS, *TEXTS]].assign(configuration=names, stuck=stuck, **parts, **own[list(sweep.axes)])
    data = plain.set_index(["configuration", *sweep.axes]).to_xarray()
    data["status"] = data.status.fillna(NO_POINT)
    for name in (*TEXTS, "stuck"):
        data[name] = data[name].fillna("").astype(str)
    for name, unit in UNITS.items():
        data[name].attrs["units"] = unit
    data["configuration"] = data.configuration.astype(str)
    versions = {str(config): identity(config) for config in sweep.configs}
    data.attrs = {"sweep": json.dumps(content_of(sweep)), "configurations": json.dumps(versions)}
    return data


def sweep_in(data: xr.Dataset) -> Sweep:
    """Give the sweep that a dataset holds.

    Raises
    ------
    ParameterError
        If the dataset is of something else.
    """
    if "sweep" not in data.attrs:
        raise ParameterError("the data hold no sweep; allowed: what multibody_xval.sweep gives, or its file")
    return sweep_of(json.loads(data.attrs["sweep"]))


def judged_table(data: xr.Dataset) -> pd.DataFrame:
    """Give the judged points of a dataset, as `dataset` took them; of a part of one, the points of that part."""
    sweep = sweep_in(data)
    names = ["configuration", *sweep.axes]
    rows = data.expand_dims([name for name in names if name not in data.dims]).to_dataframe(dim_order=names)
    rows = rows.reset_index()
    rows = rows[rows.status != NO_POINT].reset_index(drop=True)
    rows["stuck"] = rows.stuck.map(lambda text: tuple(json.loads(text)))
    for name in COMPLEX:
        rows[name] = rows.pop(f"{name}_real") + 1j * rows.pop(f"{name}_imag")
    configs = rows.configuration.map(Config.parse)
    cases = [sweep.case_at({name: row[name] for name in sweep.axes}) for row in rows.to_dict("records")]
    rows["case"] = pd.Series(cases, rows.index, dtype=object)
    described = [_described(*own) for own in zip(configs, cases, strict=True)]
    return rows.drop(columns="configuration").assign(**pd.DataFrame(described, index=rows.index))


def _described(config: Config, case: Case) -> dict[str, Any]:
    """Give what a row says of its configuration."""
    names = {"engine": config.engine, "formulation": str(config.formulation), "preset": config.preset_name}
    return {"configuration": ":".join(names.values()), **names, **of_config(config, swings=bool(case.modulation))}


def by_tolerance(table: pd.DataFrame, tolerance_db: float | None) -> pd.DataFrame:
    """Judge points by a tolerance on the error of their level that is given, if one is."""
    if tolerance_db is None:
        return table
    verdict = np.where(table.error_db.abs() <= tolerance_db, AGREES, DEVIATES)
    known = (table.status == "periodic") & table.error_db.notna()
    return table.assign(verdict=np.where(known, verdict, table.verdict))


def write(data: xr.Dataset, file: Path) -> None:
    """Write a dataset as NetCDF (``.nc``), or its points, a row a run (``.csv``)."""
    if file.suffix == ".nc":
        # in memory: HDF5 ends the process on a full disk
        write_whole(file, bytes(data.to_netcdf(engine="h5netcdf")))
    else:
        table = judged_table(data)
        write_whole(file, csv_text(file_columns(table.sort_values(["configuration", FREQUENCY]))))
