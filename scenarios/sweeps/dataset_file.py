"""Datasets of sweeps in NetCDF files, read as if a stranger had written them."""

from pathlib import Path

import h5py
import xarray as xr

from reference_lcp.refusal import ParameterError, checked_path

LARGEST_DATASET = 2**30
"""Bytes of all arrays of a dataset in memory; 20,000 points take a fiftieth of it. A compressed file may claim more."""


def read_dataset(file: Path) -> xr.Dataset:
    """Read the dataset of a sweep.

    Raises
    ------
    ParameterError
        If the file cannot be read, is no NetCDF, takes its numbers from other files, or is too large for memory.
    """
    if file.suffix != ".nc":
        raise ParameterError(f"{file} has the ending {file.suffix!r}; allowed: .nc, .toml or .sqlite")
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
