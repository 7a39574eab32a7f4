"""The command `sweep`: what it prints, writes and keeps, and how it ends."""

import signal
import sqlite3
import subprocess
import sys
import time
from contextlib import closing, suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from multibody_xval.reports.cli.console_script import app
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.exit_code import ExitCode
from multibody_xval.scenarios.model import Config, Run, failed
from multibody_xval.scenarios.running.evaluate import Means
from multibody_xval.scenarios.store import opened
from multibody_xval.scenarios.sweeps.dataset import read_dataset
from multibody_xval.scenarios.sweeps.file import EXAMPLE, read_sweep
from multibody_xval.scenarios.sweeps.swept import stored_sweep, swept

pytestmark = pytest.mark.usefixtures("here")


SWEEP = """\
engines = ["reference", "mujoco", "mujoco:joint:default"]
[grid]
friction_ratio = [0.0, 0.3]
frequency_ratio = [0.6, 1.5]
[chain]
cells = 2
"""

HOSTILE = "\x1b[2J\u202e\n[red]=1+1"


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
    assert (tmp_path / "own.toml").read_text() == EXAMPLE
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


@pytest.fixture
def failing(done: Path, tmp_path: Path) -> Path:
    """A store in which one run of MuJoCo has failed, with a reason that a terminal or a spreadsheet would obey."""
    (tmp_path / "own.toml").write_text(SWEEP)
    (tmp_path / "own.sqlite").write_bytes((done / "own.sqlite").read_bytes())
    case = replace(read_sweep(tmp_path / "own.toml").places[1].case, frequency_ratio=1.5)
    with opened(tmp_path / "own.sqlite") as store:
        store.add({Run(Config("mujoco"), case, case.steps(400)): failed(HOSTILE)})
    return tmp_path


def test_a_failure_is_counted_shown_not_obeyed_and_kept_until_it_is_asked_for_again(failing: Path, capsys) -> None:
    assert run(failing, "--no-run", "--out", str(failing / "own.csv")) == ExitCode.DONE
    printed = capsys.readouterr().out
    assert "mujoco: 1 point: \\x1b[2J\\u202e\\n[red]=1+1" in printed.replace("\n", "")
    assert printed.splitlines()[-1].endswith("none deviates. 1 have no verdict.")
    for text in (printed, (failing / "own.csv").read_text()):
        assert not {"\x1b", "\u202e"} & set(text)
    assert run(failing) == ExitCode.DONE
    assert "1 point" in capsys.readouterr().out
    assert run(failing, "--retry-failed") == ExitCode.DONE
    assert "1 point" not in capsys.readouterr().out


LARGER = """
engines = ["reference"]
[grid]
friction_ratio = [0.1, 0.3, 0.5]
frequency_ratio = { first = 0.5, last = 1.5, points = 40 }
cells = [1, 2, 3]
"""


def kept_in(store: Path) -> int:
    """Results in a store; none in one that is not there so far."""
    with suppress(sqlite3.Error), closing(sqlite3.connect(f"file:{store}?mode=ro", uri=True)) as kept:
        return int(kept.execute("SELECT count(*) FROM results").fetchone()[0])
    return 0


def kill_with(command: list[str], store: Path, results: int) -> None:
    """Start a sweep, and kill it once its store has so many results."""
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as client:
        end = time.monotonic() + 180
        while kept_in(store) < results:
            assert client.poll() is None, "the sweep ended before it could be killed"
            assert time.monotonic() < end, "the sweep keeps nothing"
            time.sleep(0.005)
        client.kill()
    assert client.returncode == -signal.SIGKILL, "the sweep had ended by itself"


@pytest.mark.slow
def test_a_sweep_that_is_killed_six_times_goes_on_and_ends_with_the_same_table(tmp_path: Path) -> None:
    (tmp_path / "own.toml").write_text(LARGER)
    file, store = str(tmp_path / "own.toml"), tmp_path / "killed.sqlite"
    command = [sys.executable, "-m", "multibody_xval", "sweep", file, "--store", str(store), "--workers", "1"]
    for _ in range(6):
        kill_with(command, store, kept_in(store) + 1)
    before = kept_in(store)
    assert subprocess.run(command, capture_output=True, check=False).returncode == ExitCode.DONE
    assert kept_in(store) > before
    data = stored_sweep(read_sweep(Path(file)), store)
    whole = swept(read_sweep(Path(file)), Means())
    xr.testing.assert_identical(data.drop_vars("seconds"), whole.drop_vars("seconds"))
