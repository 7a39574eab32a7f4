"""Sweeps: from a file, over any parameters, interrupted at any moment."""

import contextlib
import csv
import os
import signal
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.cli.console_script import app
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.local_processes import LocalExecutor
from multibody_xval.scenarios.runs.store import ResultStore
from multibody_xval.scenarios.sweeps.dataset import STATUSES, sweep_dataset, write_dataset
from multibody_xval.scenarios.sweeps.run import run_sweep, stored_points
from multibody_xval.scenarios.sweeps.spec_file import EXAMPLE, read_sweep
from multibody_xval.scenarios.sweeps.sweep import Sweep
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.errors import ParameterError
from reference_lcp.one_call import steady_state
from reference_lcp.process import run_command

SMALL = """\
engines = ["reference:joint", "mujoco:joint"]
[grid]
friction_ratio = [0.0, 0.3]
frequency_ratio = { first = 0.5, last = 1.5, points = 3 }
mass_ratio = [0.5, 1.0]
[chain]
cells = 3
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    written = tmp_path / "sweep.toml"
    written.write_text(SMALL)
    return written


def run(file: Path, *options: object) -> int:
    return run_command(app, ["sweep", str(file), "--store", str(file.with_suffix(".sqlite")), *map(str, options)])


def test_printed_example_is_read_as_its_comments_say(tmp_path: Path, capsys) -> None:
    assert run_command(app, ["example"]) == 0
    file = tmp_path / "sweep.toml"
    file.write_text(capsys.readouterr().out)
    assert file.read_text() == EXAMPLE
    asked = read_sweep(file)
    assert asked.points == 3 * 3 * 14
    assert asked.axes["frequency_ratio"][:2] == pytest.approx((0.3, 0.4))
    assert [str(variant) for variant in asked.variants] == ["reference", "mujoco", "mujoco:contact"]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[0.0, 0.3]", "[0.0, -0.3]", r"sweep.toml: grid.friction_ratio = -0.3 is outside its range; allowed: >= 0"),
        ("first = 0.5", "first = 0.0", r"grid.frequency_ratio = 0 is outside its range; allowed: > 0"),
        ("first = 0.5", "frist = 0.5", r"grid.frequency_ratio"),
        ("mass_ratio = [0.5, 1.0]", "mass_ratio = []", r"grid.mass_ratio = \[\]; allowed: at least one value"),
        ("mass_ratio = [0.5, 1.0]", "mass_ratio = [1.0, 1.0]", r"none of them twice"),
        ("mass_ratio = [0.5", "weight = [0.5", r"grid.weight is unknown; allowed: friction_ratio"),
        ("mass_ratio = [0.5, 1.0]", "cells = [2.5]", r"grid.cells = 2.5 is not a whole number"),
        ("cells = 3", "cells = 0", r"chain.cells = 0; input should be greater than or equal to 1"),
        ("cells = 3", 'cells = "3"', r"chain.cells = '3'; input should be a valid integer"),
        (
            "cells = 3",
            "damping = 3",
            r"chain.damping is unknown; allowed: cells, mass_ratio, .*; did you mean damping_ratio\?",
        ),
        ("mujoco:joint", "mujoco:glue", r"formulation of mujoco = 'glue' is unknown"),
        ("engines =", "engine =", r"sweep.toml: engines is missing"),
        ("friction_ratio = [0.0, 0.3]\n", "", r"grid.friction_ratio is missing"),
        ("[chain]", "[chain", r"sweep.toml is no TOML: .*line 6"),
    ],
)
def test_mistake_in_the_file_is_named_with_its_key_and_value(file: Path, old: str, new: str, message: str) -> None:
    assert old in SMALL
    file.write_text(SMALL.replace(old, new))
    with pytest.raises(ParameterError, match=message):
        read_sweep(file)


def test_missing_file_store_folder_and_unknown_ending_are_refused(file: Path, capsys) -> None:
    assert run(file.with_name("none.toml")) == 2
    assert "none.toml cannot be read" in capsys.readouterr().err
    assert run(file, "--out", file.with_suffix(".xlsx")) == 2
    assert "has the ending '.xlsx'; allowed: .nc or .csv" in capsys.readouterr().err
    assert run_command(app, ["sweep", str(file), "--store", str(file.parent / "none" / "s.sqlite")]) == 2
    assert f"there is no folder {file.parent / 'none'}" in capsys.readouterr().err


def test_points_are_the_steady_states_at_their_places_in_netcdf_and_csv(file: Path) -> None:
    out, table = file.with_suffix(".nc"), file.with_suffix(".csv")
    assert run(file, "--out", out) == 0
    assert run(file, "--no-run", "--out", table) == 0
    with xr.open_dataset(out) as found:
        assert dict(found.transmittance_db.sizes) == {
            "variant": 3,  # the converged reference judges
            "friction_ratio": 2,
            "frequency_ratio": 3,
            "mass_ratio": 2,
        }
        assert np.all(found.status == STATUSES.index("converged"))
        chain = Chain.from_ratios(cells=3, mass_ratio=0.5, friction_ratio=0.3)
        expected = steady_state(chain, HarmonicBase.from_ratio(chain, 1.0), with_error_bar=False).transmittance_db
        place = {"variant": "reference", "friction_ratio": 0.3, "frequency_ratio": 1.0, "mass_ratio": 0.5}
        assert float(found.transmittance_db.sel(place)) == pytest.approx(expected, abs=1e-9)
        rows = list(csv.DictReader(table.read_text().splitlines()))
        assert [float(row["transmittance_db"]) for row in rows] == found.transmittance_db.values.ravel().tolist()
        assert rows[-1]["variant"] == "mujoco"


def test_what_is_not_answered_is_missing_and_the_rest_is_shown(file: Path) -> None:
    asked = read_sweep(file)
    part = Sweep(asked.variants[:1], {**asked.axes, "mass_ratio": (0.5,)}, asked.ratios, asked.steps_per_period)
    with ResultStore(file.with_suffix(".sqlite")) as store:
        with Evaluator(store, LocalExecutor(1)) as evaluator:
            assert run_sweep(part, evaluator).statuses == {(Variant("reference"), "converged"): 6}
        found = sweep_dataset(*stored_points(asked, store))
    missing = found.status == STATUSES.index("missing")
    assert int(missing.sum()) == 18
    assert bool(np.isnan(found.transmittance_db.where(missing, drop=True)).all())


def test_written_csv_of_a_dataset_has_one_line_a_point(file: Path, tmp_path: Path) -> None:
    with ResultStore(tmp_path / "empty.sqlite") as store:
        write_dataset(sweep_dataset(*stored_points(read_sweep(file), store)), tmp_path / "empty.csv")
    assert len((tmp_path / "empty.csv").read_text().splitlines()) == 1 + 24


MANY = """\
engines = ["mujoco:joint"]
steps_per_period = 8000
[grid]
friction_ratio = {{ first = 0.1, last = 1.0, points = {rows} }}
frequency_ratio = {{ first = 0.5, last = 1.5, points = 20 }}
[chain]
cells = 10
"""
"""A sweep whose points take long enough to be killed between two of them."""


def workers_of(client: int) -> list[int]:
    children = Path(f"/proc/{client}/task/{client}/children").read_text().split()
    return [
        int(one)
        for one in children
        if "multibody_xval.scenarios.runs.worker" in Path(f"/proc/{one}/cmdline").read_text()
    ]


START_LIMIT = 180.0
"""Seconds after which a sweep that has kept nothing new, on a machine that is busy, is taken for stuck."""


def kept_in(store: Path) -> int:
    """Answers in a store; none in one that is not there so far."""
    try:
        with contextlib.closing(sqlite3.connect(f"file:{store}?mode=ro", uri=True)) as kept:
            return kept.execute("SELECT count(*) FROM answers").fetchone()[0]
    except sqlite3.OperationalError:
        return 0


def wait_for(client: subprocess.Popen[bytes], store: Path, answers: int) -> None:
    """Return when the store holds so many answers, and the client is still at work."""
    until = time.monotonic() + START_LIMIT
    while kept_in(store) < answers:
        assert client.poll() is None, "the sweep ended before it could be killed"
        assert time.monotonic() < until, "the sweep keeps nothing"
        time.sleep(0.005)


def kill_while_running(command: list[str], store: Path, answers: int, worker_first: bool) -> None:
    """Start a sweep and kill it once the store holds so many answers; one of its workers first, where asked for."""
    client = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        wait_for(client, store, answers)
        if worker_first:
            os.kill(workers_of(client.pid)[0], signal.SIGKILL)
            wait_for(client, store, kept_in(store) + 1)  # it goes on with other workers
    finally:
        client.kill()
        ended = client.wait()
    assert ended == -signal.SIGKILL, "the sweep had ended by itself"


def interrupted_sweep(folder: Path, rows: int, kills: int) -> None:
    """Kill the client, or one of its workers too, further and further on; compare the end with an undisturbed sweep."""
    file, store = folder / "many.toml", folder / "many.sqlite"
    file.write_text(MANY.format(rows=rows))
    command = [sys.executable, "-m", "multibody_xval", "sweep", str(file), "--store", str(store)]
    points = 20 * rows
    for kill in range(kills):
        kept_before = kept_in(store)
        kill_while_running(command, store, max(kept_before + 1, kill * points // (2 * kills)), bool(kill % 2))
        assert kept_before < kept_in(store) < points, "the kill hit no sweep at work"
        with sqlite3.connect(store) as kept:
            assert kept.execute("PRAGMA integrity_check").fetchone() == ("ok",)
        kept.close()
    assert subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False).returncode == 0
    asked = read_sweep(file)
    with ResultStore(store) as broken, ResultStore(folder / "whole.sqlite") as whole:
        with Evaluator(whole, LocalExecutor(2)) as evaluator:
            run_sweep(asked, evaluator)
        tables = [sweep_dataset(*stored_points(asked, one)).drop_vars(["seconds", "stored"]) for one in (broken, whole)]
    xr.testing.assert_identical(*tables)
    with sqlite3.connect(store) as kept:
        assert kept.execute("SELECT count(*), count(DISTINCT key) FROM answers").fetchone() == (points, points)
    kept.close()


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="needs Linux's list of processes")
def test_kill_that_comes_too_late_is_noticed(tmp_path: Path) -> None:
    """Twin of the sweep: a program that ends at once and keeps nothing."""
    late = [sys.executable, "-c", "pass"]
    with pytest.raises(AssertionError, match="ended before it could be killed"):
        kill_while_running(late, tmp_path / "none.sqlite", 1, worker_first=False)


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="needs Linux's list of processes")
def test_sweep_that_is_killed_six_times_goes_on_and_ends_with_the_same_table(tmp_path: Path) -> None:
    interrupted_sweep(tmp_path, rows=5, kills=6)
