"""Files of datasets: read again as they were, and one that a stranger made is refused in one line or read."""

import random
from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import pytest
import xarray as xr

from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.model import EXACT, REFERENCE, Run
from multibody_xval.scenarios.result_tables import now, points
from multibody_xval.scenarios.ruler.judge import judged
from multibody_xval.scenarios.sweeps import dataset as module
from multibody_xval.scenarios.sweeps.dataset import dataset, judged_table, read_dataset, write_dataset
from multibody_xval.scenarios.sweeps.file import sweep_of
from reference_lcp.errors import ParameterError

SWEEP = sweep_of({
    "engines": ["reference", "mujoco"], "grid": {"friction_ratio": [0.1, 0.3], "frequency_ratio": [0.7, 1.1]},
    "chain": {"cells": 2},
})  # fmt: skip


@pytest.fixture(scope="module")
def data() -> xr.Dataset:
    """MuJoCo's numbers are those of the reference."""
    results = {run: run_batch([Run(REFERENCE, run.case, run.steps)]) for run in SWEEP.runs() if run.config != EXACT}
    found = {run: own for run, (own,) in results.items()}
    return dataset(SWEEP, judged(points(now(found))))


@pytest.fixture
def file(data: xr.Dataset, tmp_path: Path) -> Path:
    write_dataset(data, tmp_path / "sweep.nc")
    return tmp_path / "sweep.nc"


def test_a_file_gives_back_the_dataset(file: Path, data: xr.Dataset) -> None:
    xr.testing.assert_identical(read_dataset(file), data)
    pd.testing.assert_frame_equal(judged_table(read_dataset(file)), judged_table(data))


NO_NETCDF = r"own\.nc cannot be read: .*; allowed: NetCDF"


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("own.nc", b"text", NO_NETCDF),
        ("own.nc", b"\x89HDF\r\n\x1a\n" + bytes(100), NO_NETCDF),
        ("own.nc", b"CDF\x01" + bytes(100), NO_NETCDF),
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


@pytest.mark.slow
def test_a_damaged_dataset_is_refused_or_read(file: Path, tmp_path: Path) -> None:
    """NetCDF has no digests: a flipped bit of a number is not noticed, but nothing ends in a traceback."""
    content, refused = file.read_bytes(), []
    for seed in range(60):
        draw, changed = random.Random(seed), bytearray(content)
        for _ in range(draw.choice([1, 20])):
            changed[draw.randrange(len(changed))] ^= 1 << draw.randrange(8)
        damaged = tmp_path / f"{seed}.nc"
        damaged.write_bytes(changed[: draw.randrange(len(changed))] if seed % 5 == 0 else changed)
        try:
            judged_table(read_dataset(damaged))
        except ParameterError as problem:
            refused.append(str(problem))
    assert len(refused) > 6
    assert {len(message.splitlines()) for message in refused} == {1}
