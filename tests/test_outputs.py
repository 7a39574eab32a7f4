"""What a command writes never takes the place of what it reads or keeps, nor of code."""

import resource
import shutil
from pathlib import Path

import pytest

from multibody_xval.reports.cli.console_script import app
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.exit_code import ExitCode
from multibody_xval.scenarios.catalogue.chains.records import EXAMPLE
from multibody_xval.scenarios.functions import sweep
from multibody_xval.scenarios.output_files import RunError
from multibody_xval.scenarios.store import Store
from multibody_xval.scenarios.sweeps.dataset import write_dataset

SWEEP = """
engines = ["reference:joint"]
[grid]
friction_ratio = [0.3]
frequency_ratio = [0.9]
"""

KEPT = b"what was there before"

ONTO_WHAT_IS_USED = [
    "sweep sweep.toml --store kept.csv --out kept.csv",
    "sweep sweep.toml --store kept.csv --out link.csv",
    "sweep sweep.toml --store link.csv --out kept.csv",
    "sweep sweep.toml --store hard.csv --out kept.csv",
    "sweep sweep.toml --store fresh.csv --out ./fresh.csv",
    "sweep sweep.csv --out sweep.csv",
    "run unit-cell --engine reference --store kept.csv --out kept.csv",
    "run record --engine reference --record record.csv --out record.csv",
    "run accuracy --engine reference --store kept.csv --out kept.csv",
    "compare kept.csv hard.csv --out link.csv",
    "report --quick --store rep/points.csv --out rep",
    "report --quick --store rep/figures/store.sqlite --out rep",
    "report --sweep rep/errors.csv --out rep",
]


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a store under several names, sweeps and a record."""
    monkeypatch.chdir(tmp_path)
    Store(Path("kept.csv")).close()
    Path("link.csv").symlink_to("kept.csv")
    Path("hard.csv").hardlink_to("kept.csv")
    Path("rep/figures").mkdir(parents=True)
    for name in ("sweep.toml", "sweep.csv", "rep/errors.csv"):
        Path(name).write_text(SWEEP)
    shutil.copy(EXAMPLE, "record.csv")
    return tmp_path


@pytest.mark.parametrize("line", ONTO_WHAT_IS_USED)
def test_an_output_onto_what_the_command_uses_is_refused_and_changes_nothing(line, files, capsys) -> None:
    before = {file: file.read_bytes() for file in files.rglob("*") if file.is_file()}
    name, *arguments = line.split()
    assert run_command(app, [name, *arguments]) == ExitCode.WRONG_INPUT
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    assert "allowed: " in message
    assert {file: file.read_bytes() for file in files.rglob("*") if file.is_file()} == before


@pytest.mark.slow
@pytest.mark.parametrize("ending", [".nc", ".csv"])
def test_a_disk_that_is_full_leaves_the_old_file_as_it_was(tmp_path, ending) -> None:
    """A limit on the size of files stands for the disk."""
    file = tmp_path / f"old{ending}"
    file.write_bytes(KEPT)
    data = sweep("reference", 0.3, [0.5, 0.9], chain={"cells": 2}, workers=1)
    old = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, old[1]))
    try:
        with pytest.raises(RunError, match=r"cannot be written: .*; it is as it was"):
            write_dataset(data, file)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, old)
    assert (list(tmp_path.iterdir()), file.read_bytes()) == ([file], KEPT)
    write_dataset(data, file)
    assert file.stat().st_size > 100
