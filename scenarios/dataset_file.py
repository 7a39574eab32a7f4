"""Files of datasets: NetCDF that any program reads, read again as if a stranger had written it; points as CSV."""

from pathlib import Path

import h5py
import xarray as xr

from multibody_xval.scenarios.dataset import COMPLEX, judged_table
from multibody_xval.scenarios.model import CASE
from multibody_xval.scenarios.output_files import write_whole
from multibody_xval.scenarios.result_tables import CONFIG, file_columns
from multibody_xval.scenarios.table_text import csv_text
from reference_lcp.errors import ParameterError, checked_path

LARGEST_DATASET = 2**30
"""Bytes of all arrays of a dataset in memory. A compressed file may claim more."""

FIRST = ("configuration", *CONFIG, "version", *CASE, "steps", "status", "verdict")
"""Columns of a table of points, before all others."""


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
            _check_size(file, opened)
            return opened.load()
    except ParameterError:
        raise
    except Exception as problem:  # HDF5, h5netcdf and xarray raise all kinds of them on a damaged file
        reason = " ".join(str(problem).split())
        raise ParameterError(f"{file} cannot be read: {reason}; allowed: NetCDF as `sweep --out` writes it") from None


def _check_size(file: Path, data: xr.Dataset) -> None:
    """Refuse arrays that take too much memory."""
    if data.nbytes > LARGEST_DATASET:
        raise ParameterError(f"{file} holds {data.nbytes:.3g} bytes; allowed: {LARGEST_DATASET:.3g}")


def _check_links(file: Path) -> None:
    """Refuse arrays that HDF5 would take out of other files."""
    with h5py.File(file, "r") as opened:
        for name in opened:
            if not isinstance(opened.get(name, getlink=True), h5py.HardLink):
                raise ParameterError(f"{file}: {name!r} is a link; allowed: arrays in the file itself")
            array = opened[name]
            if isinstance(array, h5py.Dataset) and (array.external or array.is_virtual):
                raise ParameterError(f"{file}: {name!r} lies in another file; allowed: arrays in the file itself")
