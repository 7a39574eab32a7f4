"""Every table that a command prints fits a terminal of 80 columns, and 80 columns where there is none."""

import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from multibody_xval.reports.cli.console_script import app
from multibody_xval.reports.cli.ending import run_command
from reference_lcp.errors import ExitCode

pytestmark = pytest.mark.slow

WIDTH = 80

SWEEP = """\
engines = ["reference", "exudyn-regularised:contact:relative_tolerance=1e-9:zone=0.001", "mujoco:all:default"]
[grid]
friction_ratio = [0.3]
frequency_ratio = [0.9]
mass_ratio = [1.0]
[chain]
cells = 1
[tolerances]
transmittance_db = 0.1
"""

LINES = [
    "engines",
    "engines law mujoco:joint:default",
    "reference --cells 2 --steps-per-period 400",
    "run",
    "run static-hold --engine mujoco:all:all --workers 1",
    "run all --no-run --store run.sqlite",
    "run static-hold --details --no-run --store run.sqlite",
    pytest.param("run accuracy --engine reference --workers 1", marks=pytest.mark.slow),
    "run laws --engine mujoco:joint:default",
    pytest.param("run work-precision --engine mujoco:contact:default --steps 100 --workers 1", marks=pytest.mark.slow),
    "sweep sweep.toml --store sweep.sqlite --workers 1",
    "compare sweep.sqlite lost.sqlite",
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sweep, its store, a copy of that which has lost a result, and a store of a scenario."""
    folder = tmp_path_factory.mktemp("tables")
    (folder / "sweep.toml").write_text(SWEEP)
    for words in (
        ["sweep", str(folder / "sweep.toml"), "--store", str(folder / "sweep.sqlite")],
        ["run", "static-hold", "--engine", "mujoco:all:all", "--store", str(folder / "run.sqlite")],
    ):
        assert run_command(app, [*words, "--workers", "1"]) in (ExitCode.DONE, ExitCode.FAILED)
    (folder / "lost.sqlite").write_bytes((folder / "sweep.sqlite").read_bytes())
    with closing(sqlite3.connect(folder / "lost.sqlite", isolation_level=None)) as store:
        store.execute("DELETE FROM results WHERE rowid = (SELECT max(rowid) FROM results WHERE run LIKE '%mujoco%')")
    return folder


def widest_rule(text: str) -> int:
    """Give the width of the widest table: the rule below its headings runs over all of it."""
    rules = [len(line) for line in text.splitlines() if set(line.strip()) == {"─"}]
    assert rules, text
    return max(rules)


@pytest.mark.parametrize("line", LINES)
def test_tables_of_a_command_fit(line: str, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    monkeypatch.chdir(folder)
    monkeypatch.setenv("COLUMNS", str(WIDTH))
    assert run_command(app, line.split()) in (0, 1)
    assert widest_rule(capsys.readouterr().out) <= WIDTH
