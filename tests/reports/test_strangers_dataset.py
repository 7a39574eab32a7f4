"""A dataset that a stranger made: refused in one line that names the file, or read as what it says."""

import json
import math
import random
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr

from multibody_xval.reports.cli.report import app
from multibody_xval.reports.data.collect import collect_dataset
from multibody_xval.reports.data.points import point_table
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.store import ResultStore
from multibody_xval.scenarios.sweeps import dataset_reader
from multibody_xval.scenarios.sweeps.dataset import sweep_dataset, write_dataset
from multibody_xval.scenarios.sweeps.dataset_reader import read_dataset
from multibody_xval.scenarios.sweeps.point import tasks_of
from multibody_xval.scenarios.sweeps.run import stored_points
from multibody_xval.scenarios.sweeps.spec_file import read_sweep
from reference_lcp.errors import ExitCode, ParameterError
from reference_lcp.process import run_command

SWEEP = """
engines = ["reference:joint", "reference:joint:converged", "mujoco:joint"]
[grid]
friction_ratio = [0.1, 0.3]
frequency_ratio = [0.6, 0.9, 1.3]
"""


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> xr.Dataset:
    """A dataset of numbers that no engine computed."""
    folder = tmp_path_factory.mktemp("dataset")
    (folder / "sweep.toml").write_text(SWEEP)
    sweep, draw = read_sweep(folder / "sweep.toml"), random.Random(1)
    with ResultStore(folder / "results.sqlite") as store:
        for task in tasks_of(sweep, list(sweep.grid_points())):
            result = Result(
                status="converged", transmittance_db=-60 * draw.random(), residual=1e-9, periods=30, period=0.25,
                steps_per_period=task.steps_per_period, stuck_fraction=(0.5,) * 7,
                transitions=((1, 0.1, "stick"), (2, 0.2, "forward slip")), creep=(1e-6,) * 7, seconds=0.1,
            )  # fmt: skip
            store.keep([(task, result)])
        return sweep_dataset(*stored_points(sweep, store))


@pytest.fixture(scope="module")
def written(data: xr.Dataset, tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("written") / "sweep.nc"
    write_dataset(data, file)
    return file


@pytest.fixture
def file(written: Path, tmp_path: Path) -> Path:
    """A copy that a test may change."""
    return Path(shutil.copy(written, tmp_path))


def refusal(file: Path, capsys) -> str:
    """Make a report of a file that is refused; gives the message."""
    before = file.read_bytes()
    assert run_command(app, ["--data", str(file), "--out", str(file.parent / "report")]) == ExitCode.WRONG_INPUT
    printed = capsys.readouterr().err
    assert printed.startswith(f"error: {file}")
    assert len(printed.splitlines()) == 1
    assert file.read_bytes() == before
    return printed


def test_a_dataset_without_its_points_is_refused(data) -> None:
    with pytest.raises(ParameterError, match="no variable 'stored'"):
        collect_dataset(data.drop_vars("stored"), "")
    with pytest.raises(ParameterError, match="stored has the dimensions"):
        collect_dataset(data.assign(stored=data["stored"].expand_dims("other")), "")


@pytest.mark.parametrize("name", ["variant", "friction_ratio", "frequency_ratio"])
def test_a_dataset_without_a_coordinate_is_refused(data, name) -> None:
    with pytest.raises(ParameterError, match=f"no coordinate '{name}'"):
        collect_dataset(data.drop_vars(name), "")


VALUES = [
    ("status", "finest"), ("periods", -1), ("periods", 1e300), ("periods", "many"), ("multiple", 1e300),
    ("steps_per_period", -1), ("transmittance_db", "loud"), ("stuck_fraction", [2.0]), ("stuck_fraction", [math.nan]),
    ("transitions", [[1, 0.1, "fly"]]), ("transitions", [[-1, 0.1, "stick"]]), ("transitions", [[1, 0.1]]),
    ("transitions", [[1, math.nan, "stick"]]), ("series", [1.0]), ("colour", "red"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "value"), VALUES)
def test_results_of_the_wrong_form_are_refused(data, name, value) -> None:
    texts = data["stored"].copy(deep=True)
    point = json.loads(texts.values.flat[0])
    point["result"][name] = value
    texts.values.flat[0] = json.dumps(point)
    with pytest.raises(ParameterError, match=r"(stored of|in) the dataset"):
        collect_dataset(data.assign(stored=texts), "")


@pytest.mark.parametrize("text", ["{}", "[]", "[" * 5_000, "no JSON", '{"result": {"status": "converged"}, "more": 1}'])
def test_points_of_the_wrong_form_are_refused(data, text) -> None:
    texts = data["stored"].copy(deep=True)
    texts.values.flat[0] = text
    with pytest.raises(ParameterError, match="stored of the dataset: "):
        collect_dataset(data.assign(stored=texts), "")


DESCRIPTION = {"package": "p", "version": "1", "description": "d", "options": []}


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("sweep", "[]"),
        ("sweep", "[" * 5_000),
        ("sweep", None),
        ("variants", "[]"),
        ("variants", None),
        ("variants", json.dumps({"reference": {**DESCRIPTION, "options": "all"}})),
        ("variants", json.dumps({"reference": {**DESCRIPTION, "title": "<script>alert(1)</script>"}})),
    ],
    ids=range(7),
)
def test_attributes_of_the_wrong_form_are_refused(file, capsys, name, value) -> None:
    with h5py.File(file, "a") as changed:
        del changed.attrs[name]
        if value is not None:
            changed.attrs[name] = value
    assert name in refusal(file, capsys)


def test_a_file_that_is_no_netcdf_is_refused(tmp_path, capsys) -> None:
    for number, content in enumerate([b"", b"text", b"\x89HDF\r\n\x1a\n" + bytes(100), b"CDF\x01" + bytes(100)]):
        file = tmp_path / f"{number}.nc"
        file.write_bytes(content)
        assert "cannot be read" in refusal(file, capsys)


def test_arrays_that_lie_in_other_files_are_refused(file, tmp_path, capsys) -> None:
    """An HDF5 file may name any file of its reader as the place of its numbers."""
    (tmp_path / "secret").write_bytes(bytes(144))
    with h5py.File(file, "a") as opened:
        opened.create_dataset("secret", (18,), "f8", external=[(str(tmp_path / "secret"), 0, 144)])
    assert "'secret' lies in another file" in refusal(file, capsys)
    with h5py.File(file, "a") as opened:
        del opened["secret"]
        opened["other"] = h5py.ExternalLink(str(tmp_path / "other.nc"), "/x")
    assert "'other' is a link" in refusal(file, capsys)


def test_a_small_file_of_huge_arrays_is_refused(file, data, capsys, monkeypatch) -> None:
    monkeypatch.setattr(dataset_reader, "LARGEST_DATASET", 2**20)
    huge = data.assign(zeros=("zero", np.zeros(2**18)))
    huge.to_netcdf(file, engine="h5netcdf", encoding={"zeros": {"zlib": True}})
    assert file.stat().st_size < 2**20
    assert "holds 2.2e+06 bytes" in refusal(file, capsys)


@pytest.mark.slow
@pytest.mark.parametrize("trials", [60, pytest.param(500, marks=pytest.mark.slow)])
def test_a_damaged_dataset_is_refused_or_read(file, tmp_path, trials) -> None:
    """NetCDF has no digests: a flipped bit of a number is not noticed, but nothing ends in a traceback."""
    content, refused = file.read_bytes(), 0
    for seed in range(trials):
        draw, changed = random.Random(seed), bytearray(content)
        for _ in range(draw.choice([1, 20])):
            changed[draw.randrange(len(changed))] ^= 1 << draw.randrange(8)
        damaged = tmp_path / f"{seed}.nc"
        damaged.write_bytes(changed[: draw.randrange(len(changed))] if seed % 5 == 0 else changed)
        try:
            read = collect_dataset(read_dataset(damaged), "")
            table = point_table(read.result)
        except ParameterError as problem:
            message, refused = str(problem), refused + 1
        else:
            message = str(len(table))
        assert len(message.splitlines()) == 1
    assert refused > trials / 10
