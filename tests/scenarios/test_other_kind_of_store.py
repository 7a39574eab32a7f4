"""A store of `sweep` or `report` where one of `run NAME` or `check` is needed: named as what it is, and left alone."""

import re
import sqlite3
from pathlib import Path

import pytest

from multibody_xval.reports.cli.console_script import app
from multibody_xval.scenarios import check
from multibody_xval.scenarios.store import opened
from reference_lcp.errors import ExitCode, ParameterError
from reference_lcp.process import run_command

SAID = (
    "store {file} is one of `sweep` or `report`, not of `run NAME` or `check`: `multibody-xval report --no-run --store "
    "{file}` reads it; nothing in it was changed; allowed: a store of `run NAME` or `check`, or a new file"
)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    with opened(tmp_path / "sweep.sqlite"):
        pass
    return tmp_path / "sweep.sqlite"


@pytest.mark.parametrize(
    "command", ["run unit-cell", "run unit-cell --no-run", "run laws", "run recipes", "reproduce mujoco static-hold"]
)
def test_commands_say_which_one_reads_it_and_change_nothing(file: Path, capsys, command: str) -> None:
    before = file.read_bytes()
    assert run_command(app, [*command.split(), "--store", str(file)]) == ExitCode.WRONG_INPUT
    assert capsys.readouterr().err == f"error: {SAID.format(file=file)}\n"
    assert file.read_bytes() == before
    assert [own.name for own in file.parent.iterdir()] == [file.name]


def test_check_says_it_while_a_sweep_writes_the_file(file: Path) -> None:
    with sqlite3.connect(file, isolation_level=None) as sweep:
        sweep.execute("BEGIN IMMEDIATE")
        with pytest.raises(ParameterError, match=f"^{re.escape(SAID.format(file=file))}$"):
            check("unit-cell", "mujoco", store=file)
        sweep.execute("ROLLBACK")
