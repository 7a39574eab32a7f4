"""Damage of a store: no traceback, no wrong number believed, nothing overwritten, good rows saved."""

import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from reference_lcp import ParameterError
from reference_lcp.errors import ExitCode, RunError
from reference_lcp.process import run_command
from reports.cli.console_script import app
from scenarios.runs.store import ResultStore
from scenarios.runs.store_check import check_store, salvage
from scenarios.verdicts.stored import read_all
from tests.scenarios.runs.builders import certified, files_up_to, steady

TASKS = [steady(0.5 + k / 10, cells=7) for k in range(12)]
RESULTS = [
    certified(
        cells=7, transmittance_db=-k / 3, residual=1e-9, periods=30 + k, steps_per_period=400, period=0.25,
        stuck_fraction=tuple(k / 100 + cell / 10 for cell in range(7)), seconds=0.1,
    )
    for k in range(12)
]  # fmt: skip


@pytest.fixture
def file(tmp_path: Path) -> Path:
    file = tmp_path / "results.sqlite"
    with ResultStore(file) as store:
        for pair in zip(TASKS, RESULTS, strict=True):
            store.keep([pair])
        store.note('{"a": "sweep"}')
    return file


def change(file: Path, statement: str) -> None:
    with closing(sqlite3.connect(file)) as connection, connection:
        assert connection.execute(statement).rowcount in (-1, 1)


def test_one_flipped_digit_is_refused_with_file_row_and_what_to_do(file, tmp_path, capsys) -> None:
    change(file, "UPDATE answers SET answer = replace(answer, '-1.3333', '-7.3333') WHERE rowid = 5")
    message = r"results\.sqlite is damaged: the digest of row 5 does not fit; multibody-xval store check .*--salvage"
    with ResultStore(file) as store:
        assert store.find(TASKS[0]) == RESULTS[0]
        for read in (
            lambda: store.find(TASKS[4]),
            lambda: list(store.results(TASKS)),
            lambda: list(store.all_results()),
        ):
            with pytest.raises(ParameterError, match=message):
                read()
    with pytest.raises(ParameterError, match=message):
        read_all(file)
    assert run_command(app, ["compare", str(file), str(file)]) == ExitCode.WRONG_INPUT
    assert "row 5" in capsys.readouterr().err
    assert run_command(app, ["store", "check", str(file)]) == ExitCode.WRONG_INPUT
    assert "table answers, row 5: its digest does not fit" in capsys.readouterr().out
    assert run_command(app, ["store", "check", str(file), "--salvage", str(tmp_path / "good.sqlite")]) == 0
    with ResultStore(tmp_path / "good.sqlite") as store:
        assert list(store.results(TASKS)) == [*RESULTS[:4], None, *RESULTS[5:]]
        assert store.saved() == ['{"a": "sweep"}']


def test_a_damaged_sweep_is_refused(file) -> None:
    change(file, "UPDATE sweeps SET sweep = '{}'")
    with ResultStore(file) as store, pytest.raises(ParameterError, match="the digest of row 1 does not fit"):
        store.saved()


def test_an_intact_store_has_no_damage_and_a_salvage_overwrites_nothing(file, capsys) -> None:
    found = check_store(file)
    assert not found.damage
    assert (len(found.good["answers"]), len(found.good["sweeps"])) == (12, 1)
    before = file.read_bytes()
    with pytest.raises(ParameterError, match="is there already"):
        salvage(found, file)
    assert run_command(app, ["store", "check", str(file), "--salvage", str(file)]) == ExitCode.WRONG_INPUT
    assert run_command(app, ["store", "check", str(file)]) == 0
    assert "12 intact results, 1 intact sweeps, no damages" in capsys.readouterr().out
    assert file.read_bytes() == before


def test_a_salvage_that_finds_no_room_leaves_nothing(file, tmp_path) -> None:
    good = check_store(file)
    before = set(tmp_path.iterdir())
    refused = pytest.raises(RunError, match=r"good\.sqlite cannot be written: .*; it is not there")
    with files_up_to(file.stat().st_size - 4096), refused:
        salvage(good, tmp_path / "good.sqlite")
    assert set(tmp_path.iterdir()) == before
