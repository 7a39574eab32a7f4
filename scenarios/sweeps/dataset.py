"""A sweep as labelled arrays: judged points with units, options and versions, and the sweep itself; and back again.

Files are NetCDF that any program reads, or CSV with a row a point.
"""

import json
from collections.abc import Mapping
from itertools import zip_longest
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pandas as pd
import xarray as xr

from multibody_xval.engines.interface.texts import checked_path
from multibody_xval.scenarios.compute.sources import digest
from multibody_xval.scenarios.model import CASE, REFERENCE, Case, Config, Status
from multibody_xval.scenarios.output_files import write_whole
from multibody_xval.scenarios.result_tables import CONFIG, described, file_columns
from multibody_xval.scenarios.ruler.judge import AGREES, DEVIATES
from multibody_xval.scenarios.store import identity
from multibody_xval.scenarios.sweeps.file import sweep_of
from multibody_xval.scenarios.sweeps.plan import FREQUENCY, STEPS, Sweep
from multibody_xval.scenarios.table_text import csv_text
from reference_lcp.errors import ParameterError
from reference_lcp.validation import FloatArray

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

NUMBERS = [*UNITS, *(f"{name}_{part}" for name in COMPLEX for part in ("real", "imag"))]

TEXTS = ("status", "verdict", "expected", "exact_kind", "reason", "version")

AXES = {
    "friction_ratio": "friction bound over k_c U0, μ λ_N / (k_c U0)",
    FREQUENCY: "ω / ω_r",
    "cells": "number of cells",
    "mass_ratio": "inner over outer mass",
    "stiffness_ratio": "inner over chain stiffness",
    "damping_ratio": "c_c / (2 sqrt(k_c m_o))",
    "inner_damping_ratio": "c_i / (2 sqrt(k_i m_i))",
    STEPS: "fewest steps per period",
}
"""What axes are, in words."""

FORCE_FRICTION = "friction bound over the amplitude of the force, μ λ_N / P0"
"""What the friction ratio is where a force drives the chain."""

NO_POINT = "missing"
"""Status where a sweep has no point: adaptive curves have each their own frequencies."""

FIRST = ("configuration", *CONFIG, "version", *CASE, "steps", "status", "verdict")
"""Columns of a file of points, before all others."""

LARGEST_DATASET = 2**30
"""Bytes of all arrays of a dataset in memory. A compressed file may claim more."""

WHOLE = "what multibody_xval.sweep gives, a part of it by data.sel(...), or a file of it"


def dataset(sweep: Sweep, table: pd.DataFrame) -> xr.Dataset:
    """Give the judged points of a sweep as labelled arrays: dimensions ``configuration`` and the axes of the sweep.

    Further dimensions: ``cell`` of ``stuck_fraction``, the part of the period that each contact sticks. Where the sweep
    has no point, ``status`` is ``missing``.
    """
    own = sweep.own_points(table)
    labels: dict[str, list[Any]] = {"configuration": [str(config) for config in sweep.configs], **_values(sweep, own)}
    parts = {f"{name}_{part}": getattr(np, part)(own[name]) for name in COMPLEX for part in ("real", "imag")}
    plain = own[[*UNITS, *TEXTS, "stuck"]].assign(configuration=own.config.map(str), **parts, **own[list(sweep.axes)])
    whole = pd.MultiIndex.from_product(list(labels.values()), names=list(labels))
    plain = plain.set_index(list(labels)).reindex(whole)
    stuck = plain.pop("stuck")
    texts = plain[list(TEXTS)].astype(object).fillna("").astype(str).astype(object)
    plain = plain.assign(**texts.assign(status=texts.status.where(texts.status != "", NO_POINT)))
    data = plain.to_xarray().reindex(labels)
    data["stuck_fraction"] = _by_cell(stuck, labels)
    _describe(data, sweep)
    return data


def _values(sweep: Sweep, own: pd.DataFrame) -> dict[str, list[float]]:
    """Give the values of the axes; of adaptive frequencies, those of all points."""
    values = {name: list(axis) for name, axis in sweep.axes.items()}
    if sweep.adaptive is not None:
        values[FREQUENCY] = sorted(set(own[FREQUENCY]))
    return values


def _by_cell(stuck: pd.Series, labels: Mapping[str, list[Any]]) -> xr.DataArray:
    """Give the stuck fractions of all points along a dimension ``cell``; NaN where a chain is shorter."""
    cells = list(zip_longest(*(own if isinstance(own, tuple) else () for own in stuck), fillvalue=np.nan))
    values = np.array(cells, dtype=float).reshape(len(cells), *map(len, labels.values()))
    return xr.DataArray(values, {"cell": range(1, len(cells) + 1), **labels}).transpose(..., "cell")


def _describe(data: xr.Dataset, sweep: Sweep) -> None:
    """Add units, descriptions, the sweep, and what its configurations are."""
    units = dict.fromkeys([*NUMBERS, "stuck_fraction", *sweep.axes], "1") | UNITS | {"modulation_phase": "rad"}
    for name, unit in units.items():
        if name in data.variables:
            data[name].attrs["units"] = unit
    of_force = {"friction_ratio": FORCE_FRICTION} if sweep.drive.kind == "force" else {}
    for name in sweep.axes:
        data[name].attrs["long_name"] = (AXES | of_force).get(name, name.replace("_", " "))
    known = {str(config): _identity(config) for config in sweep.configs}
    data.attrs = {"sweep": sweep.model_dump_json(exclude_none=True), "configurations": json.dumps(known)}


def _identity(config: Config) -> dict[str, str]:
    """Give version and options of a configuration, and the digest of what computes it."""
    version, options = identity(config)
    return {"version": version, "options": options, "sources": digest(config.engine)}


def sweep_in(data: Any) -> Sweep:
    """Give the sweep that a dataset, or a part of it, was taken from; its engines need not be installed.

    Raises
    ------
    ParameterError
        If the data are of something else.
    """
    if not isinstance(data, xr.Dataset):
        raise ParameterError(f"data is a {type(data).__name__}; allowed: the dataset of a sweep")
    try:
        content = json.loads(data.attrs["sweep"])
        return sweep_of(content, named=lambda names: [Config.parse(name) for name in names])
    except KeyError:
        raise ParameterError(f"the data have no attribute 'sweep'; allowed: {WHOLE}") from None
    except (TypeError, ValueError, RecursionError) as problem:
        raise ParameterError(f"attribute 'sweep' of the data: {problem}; allowed: as a sweep writes it") from None


def judged_table(data: Any) -> pd.DataFrame:
    """Give the judged points of a dataset, as `dataset` took them; of a part of one, the points of that part.

    Raises
    ------
    ParameterError
        If the data are of something else than a sweep, or lack a part of it.
    """
    sweep = sweep_in(data)
    try:
        return _with_cases(_rows(data, ["configuration", *sweep.axes]), sweep)
    except ParameterError:
        raise
    except (KeyError, ValueError, TypeError) as problem:
        raise ParameterError(f"the data are not as a sweep gives them: {problem}; allowed: {WHOLE}") from None


def _rows(data: xr.Dataset, names: list[str]) -> pd.DataFrame:
    """Give the points of data along dimensions, of which some may be single values."""
    own = data[[*NUMBERS, *TEXTS, "stuck_fraction"]]
    whole = own.expand_dims([name for name in names if name not in data.dims]).transpose(*names, "cell")
    rows = whole.drop_vars(["stuck_fraction", "cell"]).to_dataframe(dim_order=names).reset_index()
    stuck = whole.stuck_fraction.values.reshape(len(rows), whole.sizes["cell"])
    rows["stuck"] = [_present(own) for own in stuck]
    rows = rows[rows.status != NO_POINT].reset_index(drop=True)
    rows = rows.assign(status=[str(Status(own)) for own in rows.status], **rows[NUMBERS].apply(pd.to_numeric))
    rows = rows.astype({"steps": int})  # where points are missing, arrays hold floats
    for name in COMPLEX:
        rows[name] = rows.pop(f"{name}_real") + 1j * rows.pop(f"{name}_imag")
    return rows


def _present(stuck: FloatArray) -> tuple[float, ...]:
    return tuple(stuck[~np.isnan(stuck)].tolist())


def _with_cases(rows: pd.DataFrame, sweep: Sweep) -> pd.DataFrame:
    """Add what a row says of its configuration and its case."""
    configs = [Config.parse(str(name)) for name in rows.configuration]
    cases = [sweep.case_at({name: row[name] for name in sweep.axes}) for row in rows.to_dict("records")]
    labels = [described(*own) for own in zip(configs, cases, strict=True)]
    none = described(REFERENCE, Case(friction_ratio=0.0, frequency_ratio=1.0))
    columns = pd.DataFrame(labels, index=rows.index, columns=list(none))
    return columns.assign(**rows[[name for name in rows if name not in none]])


def by_tolerance(table: pd.DataFrame, tolerance_db: float | None) -> pd.DataFrame:
    """Judge points by a tolerance on the error of their level that is given, if one is."""
    if tolerance_db is None:
        return table
    verdict = np.where(table.error_db.abs() <= tolerance_db, AGREES, DEVIATES)
    known = (table.status == "periodic") & table.error_db.notna()
    return table.assign(verdict=np.where(known, verdict, table.verdict), expected="exact value")


def write_dataset(data: xr.Dataset, file: Path) -> None:
    """Write a dataset as NetCDF (``.nc``), or its points, a row a run (``.csv``)."""
    if file.suffix == ".nc":
        # in memory: HDF5 ends the process on a full disk
        write_whole(file, bytes(data.to_netcdf(engine="h5netcdf")))
        return
    table = judged_table(data).drop(columns=list(COMPLEX))
    write_whole(file, csv_text(file_columns(table[[*FIRST, *(name for name in table if name not in FIRST)]])))


def read_dataset(file: Path) -> xr.Dataset:
    """Read the dataset of a sweep; `judged_table` and `sweep_in` check what it holds.

    Raises
    ------
    ParameterError
        If the file is missing, damaged, too large in memory, or refers to other files.
    """
    if file.suffix != ".nc":
        raise ParameterError(f"{file} has the ending {file.suffix!r}; allowed: .nc")
    if not checked_path("dataset", file).is_file():
        raise ParameterError(f"{file} cannot be read: there is no such file; allowed: NetCDF")
    try:
        _check_links(file)
        with xr.open_dataset(file, engine="h5netcdf") as opened:
            size = opened.nbytes
            if size <= LARGEST_DATASET:
                return opened.load()
    except ParameterError:
        raise
    except Exception as problem:  # HDF5, h5netcdf and xarray raise all kinds of them on a damaged file
        reason = " ".join(str(problem).split())
        raise ParameterError(f"{file} cannot be read: {reason}; allowed: NetCDF as `sweep --out` writes it") from None
    raise ParameterError(f"{file} holds {size:.3g} bytes; allowed: {LARGEST_DATASET:.3g}")


def _check_links(file: Path) -> None:
    """Refuse arrays that HDF5 would take out of other files."""
    with h5py.File(file) as arrays:
        for name in arrays:
            own = arrays[name] if isinstance(arrays.get(name, getlink=True), h5py.HardLink) else None
            if own is None or (isinstance(own, h5py.Dataset) and (own.external or own.is_virtual)):
                raise ParameterError(f"{file}: {name!r} lies in another file; allowed: arrays in the file itself")
