"""The command `sweep`: what it prints, writes and keeps, and how it ends."""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from multibody_xval.reports.cli.console_script import app
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.exit_code import ExitCode
from multibody_xval.scenarios.model import Config, Run, failed
from multibody_xval.scenarios.store import opened
from multibody_xval.scenarios.sweeps.dataset import read_dataset
from multibody_xval.scenarios.sweeps.file import read_sweep

pytestmark = pytest.mark.usefixtures("here")


SWEEP = """\
engines = ["reference", "mujoco", "mujoco:joint:default"]
[grid]
friction_ratio = [0.0, 0.3]
frequency_ratio = [0.6, 1.5]
[chain]
cells = 2
"""


def run(folder: Path, *options: str) -> int:
    words = ["sweep", str(folder / "own.toml"), "--store", str(folder / "own.sqlite"), "--workers", "1", *options]
    return run_command(app, words)


@pytest.fixture(scope="module")
def done(here, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("sweep")
    (folder / "own.toml").write_text(SWEEP)
    assert run(folder, "--out", str(folder / "own.nc")) == ExitCode.DONE
    return folder


def cells(printed: str) -> dict[str, list[str]]:
    """The rows of the first table that is printed, by their first word."""
    rows = [words for line in printed.splitlines() if len(words := line.split()) > 3]
    return {first: rest for first, *rest in reversed(rows)}


def test_the_example_is_printed_as_it_is_read(tmp_path: Path, capsys) -> None:
    assert run_command(app, ["example"]) == ExitCode.DONE
    (tmp_path / "own.toml").write_text(capsys.readouterr().out)
    assert read_sweep(tmp_path / "own.toml").points == 3 * 3 * 14


def test_a_row_a_configuration_and_the_finding_last(done: Path, capsys) -> None:
    assert run(done) == ExitCode.DONE
    printed = capsys.readouterr().out
    assert cells(printed)["mujoco"][:2] == ["4", "0"]
    assert int(cells(printed)["mujoco:joint:default"][1]) > 0
    assert printed.splitlines()[-1] == "4 of 4 judged numbers agree with the exact motion, none deviates."


def test_out_of_the_store_nothing_is_run_and_the_same_is_written(done: Path, monkeypatch, capsys) -> None:
    missing = "multibody_xval.scenarios.running.evaluate.run_missing"
    monkeypatch.setattr(missing, lambda *_, **__: pytest.fail("computed"))
    assert run(done, "--no-run", "--out", str(done / "own.csv")) == ExitCode.DONE
    table, data = pd.read_csv(done / "own.csv"), read_dataset(done / "own.nc")
    np.testing.assert_array_equal(table.transmittance_db, data.transmittance_db.values.ravel())
    capsys.readouterr()
    (done / "wider.toml").write_text(SWEEP.replace("1.5]", "1.5, 1.7]"))
    words = ["sweep", str(done / "wider.toml"), "--store", str(done / "own.sqlite"), "--no-run"]
    assert run_command(app, words) == ExitCode.DONE
    assert cells(capsys.readouterr().out)["mujoco"][:3] == ["4", "0", "2"], "agrees, deviates, not run"


def test_a_failure_is_counted_and_kept_until_it_is_asked_for_again(done, tmp_path, capsys) -> None:
    for name in ("own.toml", "own.sqlite"):
        shutil.copy(done / name, tmp_path)
    case = replace(read_sweep(tmp_path / "own.toml").places[1].case, frequency_ratio=1.5)
    with opened(tmp_path / "own.sqlite") as store:
        store.add({Run(Config("mujoco"), case, case.steps(400)): failed("it\ncrashed\x1b[2J")})
    for options, shown in (["--no-run"], True), ([], True), (["--retry-failed"], False):
        assert run(tmp_path, *options) == ExitCode.DONE
        printed = capsys.readouterr().out
        assert ("mujoco: 1 point: it\\ncrashed\\x1b[2J" in printed.replace("\n", "")) == shown
        assert printed.splitlines()[-1].endswith("none deviates. 1 have no verdict.") == shown
