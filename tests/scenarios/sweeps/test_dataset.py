"""A sweep as labelled arrays with units, in memory and in a file: read again as it was; what others made is refused."""

import json
import resource
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pandas as pd
import pytest
import xarray as xr

from multibody_xval.scenarios.model import EXACT, REFERENCE, Run
from multibody_xval.scenarios.output_files import RunError
from multibody_xval.scenarios.result_tables import now, points
from multibody_xval.scenarios.ruler.judge import judged
from multibody_xval.scenarios.sweeps import dataset as module
from multibody_xval.scenarios.sweeps.dataset import (
    by_tolerance,
    dataset,
    judged_table,
    read_dataset,
    sweep_in,
    write_dataset,
)
from multibody_xval.scenarios.sweeps.file import sweep_of
from reference_lcp.errors import ParameterError
from tests.scenarios.in_this_process import result_of

SWEEP = sweep_of({
    "engines": ["reference", "mujoco"],
    "grid": {"friction_ratio": [0.3, 0.1], "frequency_ratio": [0.7, 1.1], "cells": [1, 2]},
})  # fmt: skip


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    """MuJoCo's numbers are those of the reference."""
    of = {run: run if run.config == EXACT else Run(REFERENCE, run.case, run.steps) for run in SWEEP.runs()}
    return judged(points(now({run: result_of(own) for run, own in of.items()})))


@pytest.fixture(scope="module")
def data(table: pd.DataFrame) -> xr.Dataset:
    return dataset(SWEEP, table)


@pytest.fixture
def file(data: xr.Dataset, tmp_path: Path) -> Path:
    write_dataset(data, tmp_path / "sweep.nc")
    return tmp_path / "sweep.nc"


def test_axes_are_in_the_order_of_the_sweep_and_everything_has_a_unit(data: xr.Dataset) -> None:
    assert dict(data.sizes) == dict.fromkeys(("configuration", "friction_ratio", "frequency_ratio", "cells", "cell"), 2)
    assert data.friction_ratio.values.tolist() == [0.3, 0.1]
    assert data.transmittance_db.attrs["units"] == "dB"
    for name in ("friction_ratio", "frequency_ratio", "cells", "error_db", "exact_deg", "seconds", "stuck_fraction"):
        assert "units" in data[name].attrs, name
    assert data.friction_ratio.attrs["long_name"].startswith("friction bound")
    assert sweep_in(data) == SWEEP


def test_the_judged_points_come_back_from_memory_and_from_a_file(table, data: xr.Dataset, file: Path) -> None:
    again = judged_table(data)
    order = ["configuration", "friction_ratio", "frequency_ratio", "cells"]
    names = ["case", "curve", "steps", "ratio", "exact", "status", "verdict", "stuck", "error_percent", "config",
             "version", "judged", "shares_scheme", "mass_ratio"]  # fmt: skip
    one, other = (own.sort_values(order).reset_index(drop=True)[names] for own in (again, SWEEP.own_points(table)))
    pd.testing.assert_frame_equal(one, other, check_dtype=False)
    xr.testing.assert_identical(read_dataset(file), data)
    pd.testing.assert_frame_equal(judged_table(read_dataset(file)), again)


def test_where_a_sweep_has_no_point_it_is_missing_and_a_tolerance_decides_instead_of_the_ruler(table) -> None:
    part = dataset(SWEEP, table[table.friction_ratio == 0.1])
    assert set(part.status.sel(friction_ratio=0.3).values.ravel()) == {"missing"}
    assert set(part.status.sel(friction_ratio=0.1).values.ravel()) == {"periodic"}
    assert len(judged_table(part)) == 8
    assert judged_table(part).steps.dtype == int
    assert judged_table(part.isel(frequency_ratio=slice(0, 0))).empty
    assert judged_table(dataset(SWEEP, table[:0])).empty
    assert set(by_tolerance(table, 1e-9).verdict) == {"deviates"}
    assert set(by_tolerance(table, 10.0).verdict) == {"agrees"}


FOREIGN = json.dumps({"engines": ["nope"], "grid": {"friction_ratio": [0.1], "frequency_ratio": [0.1]}})

SPOILT: dict[str, Callable[[xr.Dataset], Any]] = {
    "the data have no attribute 'sweep'": lambda data: data.drop_attrs(),
    "attribute 'sweep' of the data: engine = 'nope' is unknown": lambda data: data.assign_attrs(sweep=FOREIGN),
    "not as a sweep gives them: .*exact_real.*; allowed: ": lambda data: data.drop_vars("exact_real"),
    "not as a sweep gives them: Unable to parse string": lambda data: data.assign(transmittance_db=data.status),
    "friction_ratio = -0.3": lambda data: data.assign_coords(friction_ratio=[-0.3, 0.1]),
    "data is a DataFrame; allowed: the dataset of a sweep": lambda _: pd.DataFrame(),
}  # fmt: skip


@pytest.mark.parametrize("message", SPOILT)
def test_what_no_sweep_has_given_is_refused(data: xr.Dataset, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        judged_table(SPOILT[message](data))


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("own.nc", b"text", r"own\.nc cannot be read: .*; allowed: NetCDF"),
        ("own.nc", b"CDF\x01" + bytes(100), r"own\.nc cannot be read: .*; allowed: NetCDF"),
        ("own.txt", b"", "the ending '.txt'; allowed"),
        ("none.nc", None, "no such file"),
    ],
)
def test_a_file_that_is_missing_or_of_another_kind_is_refused(name, content, message, tmp_path: Path) -> None:
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(ParameterError, match=message):
        read_dataset(tmp_path / name)


def test_arrays_that_lie_in_other_files_are_refused(file: Path, tmp_path: Path) -> None:
    """An HDF5 file may name any file of its reader as the place of its numbers."""
    (tmp_path / "secret").write_bytes(bytes(144))
    with h5py.File(file, "a") as opened:
        opened.create_dataset("secret", (18,), "f8", external=[(str(tmp_path / "secret"), 0, 144)])
    with pytest.raises(ParameterError, match="'secret' lies in another file"):
        read_dataset(file)
    with h5py.File(file, "a") as opened:
        del opened["secret"]
        opened["other"] = h5py.ExternalLink(str(tmp_path / "other.nc"), "/x")
    with pytest.raises(ParameterError, match="'other' lies in another file"):
        read_dataset(file)


def test_a_small_file_of_huge_arrays_is_refused(data: xr.Dataset, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(module, "LARGEST_DATASET", 2**20)
    huge = data.assign(zeros=("zero", np.zeros(2**18)))
    huge.to_netcdf(tmp_path / "huge.nc", engine="h5netcdf", encoding={"zeros": {"zlib": True}})
    assert (tmp_path / "huge.nc").stat().st_size < 2**20
    with pytest.raises(ParameterError, match=r"holds 2\.1e\+06 bytes"):
        read_dataset(tmp_path / "huge.nc")


@pytest.mark.parametrize("ending", [".nc", ".csv"])
def test_a_disk_that_is_full_leaves_the_old_file_as_it_was(data: xr.Dataset, tmp_path: Path, ending: str) -> None:
    """A limit on the size of files stands for the disk."""
    file, old = tmp_path / f"old{ending}", resource.getrlimit(resource.RLIMIT_FSIZE)
    file.write_bytes(kept := b"what was there before")
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, old[1]))
    try:
        with pytest.raises(RunError, match=r"cannot be written: .*; it is as it was"):
            write_dataset(data, file)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, old)
    assert (list(tmp_path.iterdir()), file.read_bytes()) == ([file], kept)
